"""What experiments run, one file a task: settings in, a row out (experiments/FORMAT.md).

A sweep redoes what depends on an edited file, so the tasks import nothing that they do not need.
"""
