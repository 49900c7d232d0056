"""What the program and its peers cost, measured on one machine and written into the pages that say so.

`performance.py` times scenes and commands, `accuracy.py` the error that each method's time buys, `opensees.py` the same
pair in OpenSees; `__main__.py` writes them all. A machine at work for others makes all times longer: every block says
when and where it was measured, and under which load. `pictures.py` draws the pictures of the documentation that show
reports.
"""
