"""The native library: requests as JSON, results as JSON and arrays (python/native/src/lib.rs describes the interface)."""

from __future__ import annotations

import ctypes
import json
import os
import signal
import sys
import threading
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, Callable, Iterator, Optional

import numpy as np

from ._errors import Error

INTERFACE_VERSION = 1
FOLDER = Path(__file__).resolve().parent
SCENES = FOLDER / "scenes"
FMUS = FOLDER / "fmus"
STEP_FAILED = 2

_Progress = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_double)


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
        ("native_analyse", handle, [ctypes.c_char_p, handle, _Progress]),
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


@contextmanager
def _interrupts(raised: list[BaseException]) -> Iterator[None]:
    """Collects Ctrl-C during a call, in the main thread: an exception in a callback from C would be lost."""
    own = threading.current_thread() is threading.main_thread()
    if not own or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, lambda *_: raised.append(KeyboardInterrupt()))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def ask(
    request: dict[str, Any], run: Optional[Answer] = None, progress: Optional[Callable[[float], object]] = None
) -> Answer:
    """Does what the request says; raises `Error` with the library's own text where it refuses."""
    raised: list[BaseException] = []

    def report(part: float) -> int:
        # Signal handlers run here, so that Ctrl-C ends a long run.
        try:
            if progress is not None and not raised:
                progress(part)
        except BaseException as error:
            raised.append(error)
        return 1 if raised else 0

    text = json.dumps(request).encode()
    with _interrupts(raised):
        answer = Answer(library().native_analyse(text, run.handle if run else None, _Progress(report)))
    if raised:
        raise raised[0]
    if answer.status == 1:
        raise Error(answer.text)
    return answer
