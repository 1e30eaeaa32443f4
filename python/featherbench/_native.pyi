from featherbench import Error, Joint, Robot

def checksum(content: bytes) -> str: ...

__all__ = ["Error", "Joint", "Robot", "checksum"]
