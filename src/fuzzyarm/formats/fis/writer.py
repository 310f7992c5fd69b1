"""stub"""


def write_fis(*a, **k):
    raise NotImplementedError
