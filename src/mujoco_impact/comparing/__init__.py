"""What `compare` measures of each motion, and what it is measured against."""
