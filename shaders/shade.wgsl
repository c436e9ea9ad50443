// shade
