"""The studio: rule bases, control surfaces and experiments on a page in the browser.

Needs the extra ``studio``. Only `app`, `connection` and `server` know of the web.
"""
