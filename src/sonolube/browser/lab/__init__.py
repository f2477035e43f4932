"""Page Lab: runs in processes of their own, each with a page to stop it; protocols; runs compared."""
