"""CoRAL: a language model writes the cost and the contacts, a sampling-based controller moves the arm."""
