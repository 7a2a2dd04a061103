"""CoRAL's thinking: beliefs, plans, contact regions, memory and the outer loop that corrects them."""
