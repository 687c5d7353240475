"""What slicers send, byte for byte as it was recorded from PrusaSlicer 2.9.4's calls of libcurl; only the base
address, the key and the file are filled in."""

HEAD = b"Host: 127.0.0.1:5099\r\nUser-Agent: PrusaSlicer/2.9.4\r\nAccept: */*\r\n"
BOUNDARY = b"------------------------4f64f8a9d06aff81"


def key_line(key):
    """libcurl leaves a header out that has no value."""
    return b"X-Api-Key: " + key.encode() + b"\r\n" if key else b""


def get(target, key):
    return b"GET " + target.encode() + b" HTTP/1.1\r\n" + HEAD + key_line(key) + b"\r\n"


def form(fields, name, content):
    body = b""
    for field, value in fields:
        body += b"--" + BOUNDARY + b'\r\nContent-Disposition: form-data; name="' + field + b'"\r\n\r\n' + value + b"\r\n"
    body += b"--" + BOUNDARY + b'\r\nContent-Disposition: form-data; name="file"; filename="' + name + b'"\r\n'
    return body + b"Content-Type: application/octet-stream\r\n\r\n" + content + b"\r\n--" + BOUNDARY + b"--\r\n"


def post_headers(target, key, length, expect=False):
    return (b"POST " + target.encode() + b" HTTP/1.1\r\n" + HEAD + key_line(key) + b"Content-Length: "
            + str(length).encode() + b"\r\nContent-Type: multipart/form-data; boundary=" + BOUNDARY + b"\r\n"
            + (b"Expect: 100-continue\r\n" if expect else b"") + b"\r\n")


def octoprint_fields(wants_print, path=b""):
    return [(b"print", b"true" if wants_print else b"false"), (b"path", path)]


def put_headers(target, key, length, wants_print=False):
    """PrusaLink's way; Print-After-Upload is only there when the user wants to print."""
    return (b"PUT " + target.encode() + b" HTTP/1.1\r\n" + HEAD + key_line(key)
            + (b"Print-After-Upload: ?1\r\n" if wants_print else b"") + b"Content-Type: text/x.gcode\r\nOverwrite: ?1\r\n"
            + b"Content-Length: " + str(length).encode() + b"\r\nExpect: 100-continue\r\n\r\n")
