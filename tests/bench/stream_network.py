"""A connection, simulated: how long a list of files takes."""
import heapq

RATE = 10e6 / 8  # bytes per second
ROUND_TRIP = 0.04  # seconds from a request to the first byte of its answer
PARALLEL = 6  # requests at a time


def arrivals(sizes, begin=0.0, rate=RATE, round_trip=ROUND_TRIP, parallel=PARALLEL):
    """When each file is there, in seconds, if requests are made in this order from `begin` on. Answers that are on their
    way share the rate equally. One that is complete makes room for the next request."""
    waiting = [(begin + round_trip, number) for number in range(min(parallel, len(sizes)))]
    heapq.heapify(waiting)
    following = len(waiting)
    # `sent` counts the bytes that an answer would have got that is on its way all the time.
    now, sent, coming, done = begin, 0.0, [], [0.0] * len(sizes)
    while waiting or coming:
        ends = now + (coming[0][0] - sent) * len(coming) / rate if coming else float("inf")
        if waiting and waiting[0][0] <= ends:
            at, number = heapq.heappop(waiting)
            if coming:
                sent += (at - now) * rate / len(coming)
            now = at
            heapq.heappush(coming, (sent + sizes[number], number))
            continue
        sent, number = heapq.heappop(coming)
        now = ends
        done[number] = now
        if following < len(sizes):
            heapq.heappush(waiting, (now + round_trip, following))
            following += 1
    return done
