"""Draws model.png and terminalsAndIcons/terminal.png: a punch that slides and heats a strip. Needs Pillow."""

from pathlib import Path

from PIL import Image, ImageDraw

SIZE = 256
SCALE = 8  # drawn larger and reduced, for smooth edges
INK = (38, 50, 56, 255)
STEEL = (144, 164, 174, 255)
STEEL_LIGHT = (176, 190, 197, 255)
HOT = (229, 57, 53)
ARROW = (21, 101, 192, 255)


def scaled(*numbers):
    return [number * SCALE for number in numbers]


def arrow(draw, start, end, colour):
    """A straight arrow along one of the axes."""
    (x0, y0), (x1, y1) = start, end
    draw.line(scaled(x0, y0, x1, y1), fill=colour, width=12 * SCALE)
    dx, dy = (x1 > x0) - (x1 < x0), (y1 > y0) - (y1 < y0)
    tip = (x1 + 18 * dx, y1 + 18 * dy)
    left, right = (x1 - 16 * dy, y1 - 16 * dx), (x1 + 16 * dy, y1 + 16 * dx)
    draw.polygon(scaled(*tip, *left, *right), fill=colour)


def glow(image, centre, half_width, depth, downwards):
    """Heat that fades with the distance from the contact."""
    layer = Image.new("RGBA", image.size)
    draw = ImageDraw.Draw(layer)
    for row in range(depth * SCALE):
        share = 1.0 - row / (depth * SCALE)
        y = centre[1] * SCALE + (row if downwards else -row)
        reach = half_width * SCALE * (1.0 if not downwards else 0.75 + 0.25 * share)
        draw.line([centre[0] * SCALE - reach, y, centre[0] * SCALE + reach, y], fill=(*HOT, round(235 * share**1.5)))
    image.alpha_composite(layer)


def model():
    image = Image.new("RGBA", (SIZE * SCALE, SIZE * SCALE), (255, 255, 255, 0))
    draw = ImageDraw.Draw(image)
    draw.rectangle(scaled(12, 156, 244, 236), fill=STEEL)
    draw.rectangle(scaled(72, 78, 184, 156), fill=STEEL_LIGHT)
    glow(image, (128, 156), 56, 40, downwards=False)
    glow(image, (128, 156), 70, 52, downwards=True)
    draw = ImageDraw.Draw(image)
    draw.rectangle(scaled(12, 156, 244, 236), outline=INK, width=5 * SCALE)
    draw.rectangle(scaled(72, 78, 184, 156), outline=INK, width=5 * SCALE)
    arrow(draw, (128, 14), (128, 52), INK)
    arrow(draw, (194, 112), (222, 112), ARROW)
    return image.resize((SIZE, SIZE), Image.Resampling.LANCZOS)


def terminal():
    size = 32
    image = Image.new("RGBA", (size * SCALE, size * SCALE), (255, 255, 255, 0))
    draw = ImageDraw.Draw(image)
    draw.rectangle(scaled(4, 4, 28, 28), fill=ARROW, outline=INK, width=3 * SCALE)
    return image.resize((size, size), Image.Resampling.LANCZOS)


if __name__ == "__main__":
    folder = Path(__file__).parent
    model().save(folder / "model.png", optimize=True)
    terminal().save(folder / "terminalsAndIcons" / "terminal.png", optimize=True)
