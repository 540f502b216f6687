"""nginx with the configuration that samples/stream_client documents, as an ordinary user, on a free port of this machine."""
import os
import shutil
import socket
import subprocess
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CACHE_RULES = os.path.join(ROOT, 'samples', 'stream_client', 'nginx.conf')
PATHS = [*os.environ.get('PATH', '').split(os.pathsep), '/usr/sbin', '/usr/local/sbin']  # sbin is not in every PATH
PROGRAM = shutil.which('nginx', path=os.pathsep.join(PATHS))
START = 10  # seconds
BROTLI = '/usr/lib/nginx/modules/ngx_http_brotli_static_module.so'  # Debian: libnginx-mod-http-brotli-static
CONFIGURATION = '''
{modules}
{user}
worker_processes {workers};
pid nginx.pid;
error_log error.log;
events {{ worker_connections 1024; }}
http {{
  access_log off;
  sendfile on;
  tcp_nopush on;
  client_body_temp_path body;
  proxy_temp_path proxy;
  fastcgi_temp_path fastcgi;
  uwsgi_temp_path uwsgi;
  scgi_temp_path scgi;
  server {{
    listen 127.0.0.1:{port}{protocol};
    root {root};
    include {rules};
    {more}
  }}
}}
'''


def free_port():
    with socket.socket() as one:
        one.bind(('127.0.0.1', 0))
        return one.getsockname()[1]


def answers(port):
    with socket.socket() as one:
        return one.connect_ex(('127.0.0.1', port)) == 0


class Nginx:
    """Sends each site as /NAME/. sites: folders by name. brotli: also sends copies of that kind, which needs BROTLI.
    http2: HTTP/2 over TLS, with the certificate `authority`."""

    def __init__(self, sites, workers=1, brotli=False, http2=False):
        self.folder = tempfile.mkdtemp()
        self.scheme = 'https' if http2 else 'http'
        root = os.path.join(self.folder, 'root')
        os.mkdir(root)
        for name, site in sites.items():
            os.symlink(os.path.abspath(site), os.path.join(root, name))
        self.port = free_port()
        more = 'brotli_static on;' if brotli else ''
        if http2:
            more += self._make_certificate()
        configuration = os.path.join(self.folder, 'nginx.conf')
        with open(configuration, 'w', encoding='utf-8') as out:
            out.write(CONFIGURATION.format(user='' if os.getuid() else 'user root;', workers=workers, port=self.port,
                                           root=root, rules=CACHE_RULES, modules=f'load_module {BROTLI};' if brotli else '',
                                           protocol=' ssl http2' if http2 else '', more=more))
        self.process = subprocess.Popen([PROGRAM, '-p', self.folder, '-c', configuration, '-g', 'daemon off;'],
                                        stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + START
        while not answers(self.port):
            if self.process.poll() is not None or time.monotonic() > end:
                self.stop()
                raise RuntimeError(f'nginx does not start: {self.process.stderr.read()}')
            time.sleep(0.02)

    def _make_certificate(self):
        """Its lines of the configuration."""
        self.authority, key = (os.path.join(self.folder, name) for name in ('certificate.pem', 'key.pem'))
        subprocess.run(['openssl', 'req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes',
                        '-keyout', key, '-out', self.authority, '-subj', '/CN=127.0.0.1', '-days', '2',
                        '-addext', 'subjectAltName=IP:127.0.0.1'], check=True, capture_output=True)
        return f'ssl_certificate {self.authority}; ssl_certificate_key {key};'

    def url(self, name):
        return f'{self.scheme}://127.0.0.1:{self.port}/{name}/'

    def worker_seconds(self):
        """CPU seconds of all workers so far."""
        ticks = 0
        for number in os.listdir('/proc'):
            try:
                with open(f'/proc/{number}/stat', encoding='utf-8') as stat:
                    fields = stat.read().rsplit(')', 1)[1].split()
            except (OSError, IndexError):
                continue
            if int(fields[1]) == self.process.pid:  # the parent
                ticks += int(fields[11]) + int(fields[12])
        return ticks / os.sysconf('SC_CLK_TCK')

    def stop(self):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
