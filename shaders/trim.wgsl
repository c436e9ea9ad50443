// trim
