"""The site of the documentation (`cargo fmu site`): the Markdown pages of the source tree, where they are, by Sphinx."""

import re
import shutil
from pathlib import Path
from posixpath import normpath

from docutils import nodes
from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parents[2]

project = "Sliding contact"
html_title = project
extensions = ["myst_parser"]
root_doc = "README"
include_patterns = ["**.md"]
# `cargo fmu site` writes the tables of variables and scenes to target/reference; nothing else in target is a page of the site.
OTHER = [f"target/{path.name}" for path in ROOT.joinpath("target").iterdir() if path.name != "reference"]
exclude_patterns = [*OTHER, "modelDescription", "**/target", "**/.*", "**/node_modules", "**/__pycache__"]

# Formulas between dollars, and anchors as those of the Markdown that repositories show.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
# A link that leads nowhere is a warning, and every warning an error (-W).
nitpicky = True

html_theme = "furo"
html_copy_source = False
html_use_index = False
html_domain_indices = False
html_show_sphinx = False
html_show_copyright = False
html_math_renderer = "mathml"
html_static_path = ["site.css"]
html_css_files = ["site.css"]
pygments_style = "default"

# Sections of the list at the side with their pages.
SECTIONS = {
    "Use": [
        "docs/usage",
        "docs/python",
        "docs/manual",
        "docs/messages",
        "target/reference/scenes",
        "target/reference/variables",
    ],
    "Examples": [
        "examples/disc_brake/README",
        "examples/ventilated_disc/README",
        "examples/vehicle_brake/README",
        "examples/clutch/README",
        "examples/pin_on_disk/README",
        "examples/reciprocating_punch/README",
        "examples/hot_spots/README",
        "examples/batch/README",
        "examples/data/README",
    ],
    "Model": [
        "docs/theory",
        "docs/paper",
        "docs/accuracy",
        "examples/published/README",
        "docs/stability/README",
        "docs/robustness",
    ],
    "Development": [
        "CONTRIBUTING",
        "docs/architecture",
        "docs/decisions",
        "tests/golden/README",
        "benches/README",
        "docs/coverage",
        "SECURITY",
        "CHANGELOG",
    ],
}

CODE = re.compile(r"(^```.*?^```|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s#]+)(#[^)\s]*)?\)")


def read(app, name, source):
    """Adds the list of pages, and leads links to a folder to its page; those to a folder without one become text."""
    folder = Path(name).parent

    def resolved(match):
        text, target, anchor = match.groups()
        if "://" in target or not (ROOT / folder / target).is_dir():
            return match.group(0)
        page = normpath(f"{target}/README.md")
        return f"[{text}]({page}{anchor or ''})" if (ROOT / folder / page).is_file() else text

    parts = CODE.split(source[0])
    parts[::2] = [LINK.sub(resolved, part) for part in parts[::2]]
    source[0] = "".join(parts)
    if name == root_doc:
        for title, pages in SECTIONS.items():
            source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n" + "\n".join(pages) + "\n```\n"


def formula(visitor, node, display):
    """A formula as MathML, which browsers show without a script."""
    visitor.body.append(convert(node.astext().strip(), display=display))
    raise nodes.SkipNode


def finish(app, error):
    """The overview under the name that a server or a folder opens first."""
    if error is None:
        shutil.copy(Path(app.outdir, f"{root_doc}.html"), Path(app.outdir, "index.html"))


def setup(app):
    app.add_html_math_renderer(
        "mathml",
        (lambda visitor, node: formula(visitor, node, "inline"), None),
        (lambda visitor, node: formula(visitor, node, "block"), None),
    )
    app.connect("source-read", read)
    app.connect("build-finished", finish)
