"""The page of `pytpc live`: plain HTML, CSS and JavaScript, and Bokeh's script."""
