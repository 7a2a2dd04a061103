"""Where a vehicle is by its own sensors: models of Doppler log, IMU and depth sensor, and the filter over them."""
