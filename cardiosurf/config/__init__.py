"""The YAML schema and its loader: the only place that meets a dict."""
