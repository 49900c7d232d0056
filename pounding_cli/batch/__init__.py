"""Running plans: the cache of solved scenes, workers, progress."""
