#!/usr/bin/python3
"""What nginx does for many walks at a time: requests of recorded walks, in real time, on connections that stay open.

usage: bench_stream_server.py --walks FOLDER [--speed M/S] [--visit S] [--connections N] [--seconds S] [--workers N]
                              [--results DIR] --site NAME=FOLDER ...

--walks: what bench_stream_walks.py --keep has kept of these sites: NAME-SPEED-NUMBER/requests.csv. Each connection is a
client of its own that repeats one walk, from the front on, every --visit seconds. They begin at evenly spread times of their walks, so each moment
has clients that have just come and clients that have walked for long. A connection has one request at a time. Clients accept
gzip.

Prints a row per site: requests and bytes with headers per second; CPU seconds per second of the workers of nginx, and of this
program; latency from the request to the last byte of its answer; and how late this program's loop noticed that a request was
due: its own part of a latency is about as much.
"""
import argparse
import asyncio
import csv
import os
import sys
import time

sys.dont_write_bytecode = True  # nothing is written into the sources
sys.path[:0] = [os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "stream")]
import nginx_server  # noqa: E402
import numpy as np  # noqa: E402
import result_files  # noqa: E402


def walk_of(path, prefix):
    """Times and requests."""
    with open(path, encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    fields = "HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n"
    return [(float(row["seconds"]), f"GET /{prefix}/{row['name']} {fields}".encode()) for row in rows]


def walks_of(folder, name, speed):
    numbers = sorted(entry for entry in os.listdir(folder) if entry.startswith(f"{name}-{speed:g}-"))
    walks = [walk_of(os.path.join(folder, entry, "requests.csv"), name) for entry in numbers]
    if not walks:
        raise SystemExit(f"{folder} has no walk of {name} at {speed:g} m/s: run bench_stream_walks.py --keep")
    return walks


class Counts:
    """What all connections together have measured, once `running` is set."""

    def __init__(self):
        self.running, self.bytes, self.latencies, self.lags, self.bad = False, 0, [], [], []


class Client(asyncio.Protocol):
    """A connection with the requests of one walk."""

    def __init__(self, counts, walk, visit, offset):
        """visit: seconds from one begin of the walk to the next one. offset: the share of it that is over at first."""
        self.counts, self.walk, self.loop = counts, walk, asyncio.get_running_loop()
        self.length = max(visit, walk[-1][0])
        self.offset = offset * self.length
        self.next = next((i for i, (at, _) in enumerate(walk) if at >= self.offset), len(walk))
        self.head, self.left, self.sent, self.ended, self.transport = b"", None, 0.0, False, None

    def connection_made(self, transport):
        self.transport = transport

    def begin(self, now):
        self.origin = now - self.offset  # when this round of the walk began
        self.wait()

    def wait(self):
        if self.next == len(self.walk):
            self.next, self.origin = 0, self.origin + self.length
        due = self.origin + self.walk[self.next][0]
        if due > self.loop.time():
            self.loop.call_at(due, self.due, due)
        else:
            self.send()

    def due(self, due):
        if self.counts.running:
            self.counts.lags.append(self.loop.time() - due)
        self.send()

    def send(self):
        if self.ended:
            return
        self.sent, self.head, self.left = time.perf_counter(), b"", None
        self.transport.write(self.walk[self.next][1])
        self.next += 1

    def data_received(self, data):
        counts = self.counts
        if counts.running:
            counts.bytes += len(data)
        if self.left is None:
            self.head += data
            end = self.head.find(b"\r\n\r\n")
            if end < 0:
                return
            fields = self.head[:end].lower().split(b"\r\n")
            sizes = [int(field.split(b":")[1]) for field in fields if field.startswith(b"content-length:")]
            if fields[0].split()[1] != b"200" or len(sizes) != 1:
                counts.bad.append(self.walk[self.next - 1][1].split()[1].decode())
            self.left = sum(sizes) - (len(self.head) - end - 4)
        else:
            self.left -= len(data)
        if self.left <= 0:
            if counts.running:
                counts.latencies.append(time.perf_counter() - self.sent)
            self.wait()

    def connection_lost(self, _):
        if not self.ended:
            self.counts.bad.append("a connection was closed")

    def end(self):
        self.ended = True
        self.transport.close()


async def load(port, walks, visit, connections, seconds):
    """Runs all clients; calls them measured from when all are connected."""
    loop, counts, clients = asyncio.get_running_loop(), Counts(), []
    for number in range(connections):
        walk = walks[number % len(walks)]
        _, client = await loop.create_connection(lambda w=walk, n=number: Client(counts, w, visit, n / connections), "127.0.0.1", port)
        clients.append(client)
    for client in clients:
        client.begin(loop.time())
    await asyncio.sleep(min(1.0, seconds / 10))
    return counts, clients


async def measure(server, walks, arguments):
    counts, clients = await load(server.port, walks, arguments.visit, arguments.connections, arguments.seconds)
    counts.running = True
    begin, nginx, own = time.perf_counter(), server.worker_seconds(), time.process_time()
    await asyncio.sleep(arguments.seconds)
    counts.running = False
    elapsed = time.perf_counter() - begin
    nginx, own = server.worker_seconds() - nginx, time.process_time() - own
    for client in clients:
        client.end()
    if counts.bad:
        raise SystemExit(f"{len(counts.bad)} requests have failed, the first one: {counts.bad[0]}")
    percentiles = np.percentile(counts.latencies, (50, 95)) * 1000
    return {"connections": len(clients), "seconds": elapsed, "requests_per_second": len(counts.latencies) / elapsed,
            "bytes_per_second": counts.bytes / elapsed, "nginx_cpu": nginx / elapsed, "generator_cpu": own / elapsed,
            "latency_50_ms": float(percentiles[0]), "latency_95_ms": float(percentiles[1]),
            "generator_lag_50_ms": float(np.percentile(counts.lags, 50)) * 1000,
            "generator_lag_95_ms": float(np.percentile(counts.lags, 95)) * 1000}


def parsed():
    parser = argparse.ArgumentParser()
    parser.add_argument("--walks", required=True, metavar="FOLDER")
    parser.add_argument("--speed", type=float, default=1.5)
    parser.add_argument("--visit", type=float, default=60, help="seconds that the recorded walks took")
    parser.add_argument("--connections", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--site", action="append", required=True, dest="sites", metavar="NAME=FOLDER")
    result_files.add_option(parser)
    return parser.parse_args()


def main():
    arguments = parsed()
    if nginx_server.PROGRAM is None:
        print("nginx is not installed (scripts/bootstrap --tests)", file=sys.stderr)
        return 77
    sites = dict(site.split("=", 1) for site in arguments.sites)
    rows = []
    print("scene | requests/s | MB/s | CPU of nginx | of this program | latency 50 % | 95 % | lag of this program 50 % | 95 %")
    with nginx_server.Nginx(sites, arguments.workers) as server:
        for name in sites:
            walks = walks_of(arguments.walks, name, arguments.speed)
            rows.append({"scene": name, **asyncio.run(measure(server, walks, arguments))})
            one = rows[-1]
            print(f"{name} | {one['requests_per_second']:.0f} | {one['bytes_per_second'] / 1e6:.2f} | {one['nginx_cpu']:.3f} | "
                  f"{one['generator_cpu']:.3f} | {one['latency_50_ms']:.2f} ms | {one['latency_95_ms']:.2f} ms | "
                  f"{one['generator_lag_50_ms']:.2f} ms | {one['generator_lag_95_ms']:.2f} ms", flush=True)
    result_files.write(arguments.results, "stream_server", "nginx as the server of many walks at a time.", rows,
                       [f"Walks at {arguments.speed:g} m/s, visits of {arguments.visit:g} s, {arguments.workers} worker of nginx on the machine of the clients."])
    return 0


if __name__ == "__main__":
    sys.exit(main())
