"""A web server for a folder that injects faults: the kind of each answer follows from a seed, the path and how often it was
asked for, so not from the order of requests.

Faults of ERRORS make a request fail; those of HARMLESS are unusual answers with the right bytes.
"""
import gzip
import http.server
import os
import random
import socket
import socketserver
import struct
import threading
import time
import zlib

STALLED = 100  # seconds that the server keeps a connection open on which it sends nothing
ERRORS = ('reset', 'reset in body', 'closed', 'cut', 'short', 'long', 'flipped', 'other file', 'empty', '404', '500', '503',
          'endless', 'endless chunks', 'endless headers', 'redirect to itself', 'no http', 'broken chunk', 'length twice',
          'false encoding', 'not asked to compress', 'cut in compressed', 'other file compressed', 'compressed twice', 'endless compressed',
          'other encoding', 'unknown encoding')
STALLS = ('stalled', 'stalled in body', 'dripping')  # these take the client as long as it waits
HARMLESS = ('late', 'chunked', 'compressed', 'http 1.0', 'redirected', 'in pieces')


class Plan:
    """What is done with each request."""

    def __init__(self, seed=0, in_a_row=0, stalls=0.0, harmless=0.2, missing=(), always=()):
        """in_a_row: most errors of a path one after the other. stalls, harmless: shares of the faults. missing: paths that do
        not exist for the client. always: by path, the kind of all its answers."""
        self.always = dict(always)
        self.seed, self.in_a_row, self.stalls, self.harmless, self.missing = seed, in_a_row, stalls, harmless, set(missing)
        self.asked, self.left, self.counts = {}, {}, {}
        self.lock = threading.Lock()

    def next(self, path):
        """The fault of this request, or None."""
        with self.lock:
            self.asked[path] = number = self.asked.get(path, 0) + 1
            if path in self.missing:
                return self.count('404')
            if path in self.always:
                return self.count(self.always[path])
            if not self.in_a_row:
                return None
            one = random.Random(f'{self.seed} {path} {number}')
            if not self.left.get(path):
                self.left[path] = one.randint(1, self.in_a_row + 1)
            self.left[path] -= 1
            if not self.left[path]:
                return None
            share = one.random()
            if share < self.harmless:
                self.left[path] = 0
                return self.count(one.choice(HARMLESS))
            return self.count(one.choice(STALLS if share < self.harmless + self.stalls else ERRORS))

    def count(self, kind):
        self.counts[kind] = self.counts.get(kind, 0) + 1
        return kind


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = 'HTTP/1.1'
    disable_nagle_algorithm = True

    def log_message(self, *_):
        pass

    def do_GET(self):
        server, path = self.server, self.path.split('?')[0].lstrip('/')
        try:
            if '?plain' in self.path:
                self.send(server.contents(path))
            else:
                self.answer(server.plan.next(path), server.contents(path), path)
        except (ConnectionError, TimeoutError, BrokenPipeError):
            self.close_connection = True

    def send(self, data, status=200, length=None, headers=(), body=None):
        if data is None:
            status, data = 404, b'there is no such file'
        lines = [f'HTTP/1.1 {status} ?', *headers]
        if length != '':
            lines.append(f'Content-Length: {len(data) if length is None else length}')
        self.wfile.write('\r\n'.join([*lines, '', '']).encode() + (data if body is None else body))

    def close(self, reset=False):
        """A reset drops what the client has not received yet."""
        if reset:
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
            self.connection.close()
        self.close_connection = True

    def wait(self):
        """Until the client closes."""
        self.connection.settimeout(STALLED)
        self.connection.recv(1)
        self.close()

    def answer(self, kind, data, path):
        if kind is None or data is None:
            return self.send(None if kind == '404' else data)
        half, flipped = len(data) // 2, bytearray(data)
        name = ''.join(c if c.isalnum() else '_' for c in kind)
        special = getattr(self, 'answer_' + name, None)
        if special:
            return special(data, half)
        if kind == 'flipped':
            flipped[random.Random(path).randrange(len(data))] ^= 1 << len(data) % 8
            return self.send(bytes(flipped))
        if kind == 'other file':
            return self.send(self.server.other_than(path))
        if kind == 'other file compressed':
            return self.send_encoded(gzip.compress(self.server.other_than(path), 1))
        return self.send(b'out of order', status=int(kind))

    def answer_reset(self, *_):
        self.close(reset=True)

    def answer_reset_in_body(self, data, half):
        self.send(data, body=data[:half])
        self.close(reset=True)

    def answer_closed(self, *_):
        self.close()

    def answer_cut(self, data, half):
        self.send(data, body=data[:half])
        self.close()

    def answer_short(self, data, half):
        self.send(data[:half])

    def answer_long(self, data, _):
        self.send(data + b'more')

    def answer_empty(self, *_):
        self.send(b'')

    def answer_404(self, *_):
        self.send(None)

    def answer_endless(self, data, _):
        self.send(data, length='', headers=['Connection: close'])
        self.flood(b'x' * 65536)

    def answer_endless_chunks(self, *_):
        self.send(b'', length='', headers=['Transfer-Encoding: chunked'])
        self.flood(b'10000\r\n' + b'x' * 65536 + b'\r\n')

    def answer_endless_headers(self, *_):
        self.wfile.write(b'HTTP/1.1 200 ?\r\n')
        self.flood(b'X-More: ' + b'x' * 1000 + b'\r\n')

    def flood(self, block):
        """As much as a client takes, up to 64 MB."""
        for _ in range((64 << 20) // len(block)):
            self.wfile.write(block)
        self.close()

    def answer_redirect_to_itself(self, *_):
        self.send(b'', status=302, headers=['Location: ' + self.path])

    def answer_no_http(self, *_):
        self.wfile.write(b'220 mail server ready\r\n')
        self.close()

    def answer_broken_chunk(self, data, half):
        self.send(b'', length='', headers=['Transfer-Encoding: chunked'],
                  body=b'%x\r\n' % len(data) + data[:half] + b'\r\nno number\r\n')
        self.close()

    def send_encoded(self, data, encoding='gzip', **more):
        self.send(data, headers=[f'Content-Encoding: {encoding}', 'Vary: Accept-Encoding'], **more)

    def answer_compressed(self, data, _):
        if 'gzip' in self.headers.get('Accept-Encoding', ''):
            self.send_encoded(gzip.compress(data, 1))
        else:
            self.send(data)

    def answer_not_asked_to_compress(self, data, _):
        """Wrong only where the client does not accept it."""
        self.send_encoded(gzip.compress(data, 1))

    def answer_false_encoding(self, data, _):
        """Wrong only where the client accepts it."""
        self.send_encoded(data)

    def answer_cut_in_compressed(self, data, _):
        packed = gzip.compress(data, 1)
        self.send_encoded(packed[:len(packed) // 2])

    def answer_compressed_twice(self, data, _):
        self.send_encoded(gzip.compress(gzip.compress(data, 1), 1))

    def answer_endless_compressed(self, data, _):
        """The file, and then up to 64 MB per 64 KB that are sent."""
        packer = zlib.compressobj(1, wbits=zlib.MAX_WBITS | 16)
        begin = packer.compress(data) + packer.flush(zlib.Z_FULL_FLUSH)
        self.send_encoded(begin, length='')
        self.flood(packer.compress(bytes(16 << 20)) + packer.flush(zlib.Z_FULL_FLUSH))

    def answer_other_encoding(self, data, _):
        self.send_encoded(gzip.compress(data, 1), 'br')

    def answer_unknown_encoding(self, data, _):
        self.send_encoded(gzip.compress(data, 1), 'zip')

    def answer_length_twice(self, data, half):
        self.send(data, headers=[f'Content-Length: {half}'])
        self.close()

    def answer_stalled(self, *_):
        self.wait()

    def answer_stalled_in_body(self, data, half):
        self.send(data, body=data[:half])
        self.wait()

    def answer_dripping(self, data, _):
        self.send(data, body=b'')
        for byte in data[:200]:
            self.wfile.write(bytes([byte]))
            time.sleep(0.05)
        self.close()

    def answer_late(self, data, _):
        time.sleep(0.02)
        self.send(data)

    def answer_chunked(self, data, half):
        chunks = b''.join(b'%x\r\n%s\r\n' % (len(part), part) for part in (data[:half], data[half:]) if part)
        self.send(b'', length='', headers=['Transfer-Encoding: chunked'], body=chunks + b'0\r\n\r\n')

    def answer_http_1_0(self, data, _):
        self.wfile.write(b'HTTP/1.0 200 ?\r\n\r\n' + data)
        self.close()

    def answer_redirected(self, *_):
        self.send(b'', status=302, headers=[f'Location: {self.path}?plain'])

    def answer_in_pieces(self, data, half):
        self.send(data, body=data[:half])
        time.sleep(0.01)
        self.wfile.write(data[half:])


class Server(socketserver.ThreadingMixIn, socketserver.TCPServer):
    """Runs in threads of this process until `stop`."""
    daemon_threads, block_on_close, allow_reuse_address, request_queue_size = True, False, True, 64

    def __init__(self, folder, plan=None):
        super().__init__(('127.0.0.1', 0), Handler)
        self.folder, self.plan, self.files = folder, plan or Plan(), {}
        for place, _, names in os.walk(folder):
            for name in names:
                path = os.path.join(place, name)
                with open(path, 'rb') as file:
                    self.files[os.path.relpath(path, folder).replace(os.sep, '/')] = file.read()
        self.changes = {}  # path: list of contents, each for one request; the last one stays
        self.url = f'http://127.0.0.1:{self.server_address[1]}/'
        threading.Thread(target=self.serve_forever, kwargs={'poll_interval': 0.02}, daemon=True).start()

    def contents(self, path):
        following = self.changes.get(path)
        if following:
            return following.pop(0) if len(following) > 1 else following[0]
        return self.files.get(path)

    def other_than(self, path):
        """Bytes of another file, as many if there is one."""
        data, others = self.files[path], [(name, d) for name, d in self.files.items() if name != path]
        return min(others, key=lambda other: (abs(len(other[1]) - len(data)), other[0]))[1]

    def handle_error(self, *_):
        pass  # of connections that the client has closed

    def stop(self):
        self.shutdown()
        self.server_close()
