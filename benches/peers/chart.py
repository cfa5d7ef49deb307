"""Time against unknowns, log-log, one line for each program, as SVG."""

from math import ceil, floor, log10

from peers import OURS, PEERS

WIDTH, HEIGHT = 900, 560
LEFT, RIGHT, TOP, BOTTOM = 80, 640, 60, 490


def draw(rows, material="a", threads=1):
    rows = [
        row
        for row in rows
        if row["columns"] == 1 and (row["material"], row["threads"]) == (material, threads) and "total_s" in row
    ]
    x = Axis([row["unknowns"] for row in rows], LEFT, RIGHT)
    y = Axis([row["total_s"] for row in rows], BOTTOM, TOP)
    parts = [head(), *grid(x, y)]
    ends = []
    for peer in [*PEERS, OURS]:
        points = sorted((row["unknowns"], row["total_s"]) for row in rows if row["program"] == peer.name)
        if points:
            places = [(x.place(u), y.place(t)) for u, t in points]
            parts.append(line(peer, places))
            ends.append((places[-1][1], peer))
    parts += legend(ends)
    return "\n".join([*parts, "</svg>\n"])


class Axis:
    """A logarithmic axis with some room at both ends."""

    def __init__(self, values, begin, end):
        self.low, self.high = log10(min(values)) - 0.1, log10(max(values)) + 0.1
        self.begin, self.end = begin, end

    def place(self, value):
        share = (log10(value) - self.low) / (self.high - self.low)
        return self.begin + share * (self.end - self.begin)

    def ticks(self):
        """1, 2 and 5 times powers of ten."""
        powers = range(floor(self.low), ceil(self.high) + 1)
        values = [float(f"{factor}e{power}") for power in powers for factor in (1, 2, 5)]
        return [value for value in values if self.low <= log10(value) <= self.high]


def head():
    middle = (LEFT + RIGHT) / 2
    return f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" \
font-family="DejaVu Sans, Verdana, sans-serif" font-size="14">
<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>
<text x="{LEFT}" y="26" font-size="17">Time of one prediction, mesh in memory to displacement in memory</text>
<text x="{LEFT}" y="46" fill="#555">Face-like shells of plain tetrahedra, E 15 kPa, nu 0.46, residual 1e-8, one thread</text>
<text x="{middle}" y="{BOTTOM + 48}" text-anchor="middle">Unknowns</text>
<text transform="translate(24 {(TOP + BOTTOM) / 2}) rotate(-90)" text-anchor="middle">Time, s</text>"""


def grid(x, y):
    for value in x.ticks():
        at, label = x.place(value), f"{value / 1000:g} k" if value < 1e6 else f"{value / 1e6:g} M"
        yield f'<path d="M{at:.1f} {TOP}V{BOTTOM}" stroke="#ddd"/>'
        yield f'<text x="{at:.1f}" y="{BOTTOM + 22}" text-anchor="middle">{label}</text>'
    for value in y.ticks():
        at = y.place(value)
        yield f'<path d="M{LEFT} {at:.1f}H{RIGHT}" stroke="#ddd"/>'
        yield f'<text x="{LEFT - 8}" y="{at + 5:.1f}" text-anchor="end">{value:g}</text>'
    yield f'<rect x="{LEFT}" y="{TOP}" width="{RIGHT - LEFT}" height="{BOTTOM - TOP}" fill="none" stroke="#555"/>'


def line(peer, places):
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
    width = 4 if peer is OURS else 2
    stroke = f'stroke="{peer.colour}" stroke-width="{width}" stroke-dasharray="{peer.dash}"'
    marks = "".join(mark(peer, *place) for place in places)
    return f'<path d="{path}" fill="none" {stroke}/>{marks}'


def mark(peer, x, y):
    shapes = {
        "circle": f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5"',
        "square": f'<rect x="{x - 4.5:.1f}" y="{y - 4.5:.1f}" width="9" height="9"',
        "diamond": f'<path d="M{x:.1f} {y - 6.5:.1f}l6.5 6.5l-6.5 6.5l-6.5 -6.5z"',
        "triangle": f'<path d="M{x:.1f} {y - 6.5:.1f}l6 11h-12z"',
    }
    return shapes[peer.mark] + f' fill="{peer.colour}" stroke="white"/>'


def legend(ends):
    """Names beside the chart, in the order in which the lines end."""
    ends.sort(key=lambda end: end[0])
    step = 26
    top = min(max(TOP + 10, ends[0][0]), BOTTOM - step * (len(ends) - 1)) if ends else TOP
    places = [top + step * index for index in range(len(ends))]
    for (y, peer), at in zip(ends, places):
        weight = ' font-weight="bold"' if peer is OURS else ""
        yield line(peer, [(RIGHT + 16, at), (RIGHT + 52, at)])
        yield f'<text x="{RIGHT + 64}" y="{at + 5:.1f}"{weight}>{peer.title}</text>'
