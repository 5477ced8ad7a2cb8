"""The native library: requests as JSON, results as JSON and arrays (python/native/src/lib.rs describes the interface)."""

from __future__ import annotations

import ctypes
import json
import os
import sys
import threading
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, Callable, Iterable, Optional, TypeVar

import numpy as np

from ._errors import Error, Interrupted

INTERFACE_VERSION = 3
FOLDER = Path(__file__).resolve().parent
SCENES = FOLDER / "scenes"
FMUS = FOLDER / "fmus"
REFUSED = 1

_PAUSE = 0.1  # s, between two looks at a call that lasts

Result = TypeVar("Result")


class Control(ctypes.Structure):
    """`Control` of the native libraries: what this thread shares with a call that lasts."""

    _fields_ = [("stop", ctypes.c_bool), ("part", ctypes.c_double)]


def library_path() -> Path:
    """File of the native library; the environment variable SLIDING_CONTACT_LIBRARY names another one than the package's own."""
    given = os.environ.get("SLIDING_CONTACT_LIBRARY")
    if given:
        return Path(given)
    name = {"win32": "sliding_contact_native.dll", "darwin": "libsliding_contact_native.dylib"}
    return FOLDER / name.get(sys.platform, "libsliding_contact_native.so")


@lru_cache(maxsize=None)
def library() -> ctypes.CDLL:
    """The loaded library. ctypes releases the interpreter's lock during every call."""
    path = library_path()
    if not path.is_file():
        raise ImportError(f"{path} is missing: install the wheel, or `pip install .` in the source tree")
    loaded = ctypes.CDLL(str(path))
    handle, size = ctypes.c_void_p, ctypes.c_size_t
    for name, result, arguments in (
        ("native_interface_version", ctypes.c_uint32, []),
        ("native_analyse", handle, [ctypes.c_char_p, handle, ctypes.POINTER(Control)]),
        ("native_status", ctypes.c_uint32, [handle]),
        ("native_text", ctypes.c_char_p, [handle]),
        ("native_arrays", size, [handle]),
        ("native_array", ctypes.POINTER(ctypes.c_double), [handle, size, ctypes.POINTER(size)]),
        ("native_free", None, [handle]),
    ):
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    version = loaded.native_interface_version()
    if version != INTERFACE_VERSION:
        raise ImportError(f"{path} has the interface version {version}, this package needs {INTERFACE_VERSION}")
    return loaded


class Answer:
    """Result of a request; keeps the native run that figures and comparisons follow from."""

    def __init__(self, handle: int) -> None:
        self._handle = handle
        self.status = int(library().native_status(handle))
        self.text = bytes(library().native_text(handle)).decode()

    def __del__(self) -> None:
        handle, self._handle = getattr(self, "_handle", None), 0
        if handle:
            library().native_free(handle)

    def __reduce__(self) -> Any:
        raise TypeError("a simulation belongs to its process; pass on its arrays or its frame()")

    @property
    def handle(self) -> int:
        return self._handle

    @property
    def record(self) -> Any:
        return json.loads(self.text)

    def array(self, index: int) -> np.ndarray:
        """A copy of an array."""
        length = ctypes.c_size_t()
        first = library().native_array(self._handle, index, ctypes.byref(length))
        if not length.value:
            return np.empty(0)
        return np.ctypeslib.as_array(first, shape=(length.value,)).copy()


def attended(
    call: Callable[[Control], Result],
    progress: Optional[Callable[[float], object]] = None,
    kept: Callable[[Result], Optional[BaseException]] = lambda _: None,
) -> Result:
    """Makes a native call on a thread of its own and calls `progress` here with the part that is done.

    So handlers of signals run in this thread as in any Python code. What they or `progress` raise ends the call and is raised here; instead
    of Ctrl-C that which `kept` makes of the unfinished result.
    """
    control = Control()
    # Not `Thread.join`: interrupted by a signal, it takes the thread for ended (Python 3.11).
    ended = threading.Event()
    results: list[Result] = []
    failures: list[BaseException] = []

    def work() -> None:
        try:
            results.append(call(control))
        except BaseException as error:
            failures.append(error)
        finally:
            ended.set()

    threading.Thread(target=work, name="sliding_contact", daemon=True).start()
    try:
        while not ended.wait(_PAUSE):
            if progress is not None:
                progress(control.part)
    except BaseException as error:
        control.stop = True
        # A second signal waits too: what the call uses must not be freed under it.
        while not ended.is_set():
            with suppress(BaseException):
                ended.wait()
        partial = kept(results[0]) if results and isinstance(error, KeyboardInterrupt) else None
        if partial is not None:
            raise partial from None
        raise
    if failures:
        raise failures[0]
    return results[0]


def ask(
    request: dict[str, Any],
    run: Optional[Answer] = None,
    progress: Optional[Callable[[float], object]] = None,
    kept: Optional[Callable[[Answer], Interrupted]] = None,
) -> Answer:
    """Does what the request says; raises `Error` with the library's own text where it refuses, and at Ctrl-C what `kept` makes of the part that is done."""
    text = json.dumps(request).encode()
    handle = run.handle if run else None

    def partial(answer: Answer) -> Optional[BaseException]:
        return None if kept is None or answer.status == REFUSED or answer.record is None else kept(answer)

    answer = attended(lambda control: Answer(library().native_analyse(text, handle, ctypes.byref(control))), progress, partial)
    if answer.status == REFUSED:
        raise Error(answer.text)
    return answer


def meant(name: str, names: Iterable[str], where: str) -> str:
    """The end of a message about an unknown name: those like it, else `where` all are."""
    return ask({"analysis": "nearest", "name": name, "names": sorted(set(names))}).record or f"; `{where}` has the names"
