"""How to go there: DDP-MPPI, PD control, the path monitor, and the way round other vehicles."""
