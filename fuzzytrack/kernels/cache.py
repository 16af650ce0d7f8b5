"""Compiled code kept on disk, so that another process need not compile it again."""

from __future__ import annotations

import hashlib
import os
import pickle
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core.caching import CompileResultCacheImpl, _Cache
from numba.core.serialize import dumps

__all__ = ["KernelCache"]

#: Files kept; the oldest go first.
KEPT = 400


class KernelCache(_Cache):
    """Keeps what Numba makes of one function in files, one for each signature.

    Numba's own cache tells closures apart by pickling them, which for compiled helpers gives other
    bytes in every process, and keeps an index that two processes may overwrite for one another.

    Parameters
    ----------
    function : callable
        The function that is compiled, defined in a file.
    digest : str
        See `fuzzytrack.kernels.compile.fingerprint`.
    """

    def __init__(self, function: Callable[..., Any], digest: str) -> None:
        self._implementation: Any = CompileResultCacheImpl(function)
        self._folder = Path(self._implementation.locator.get_cache_path())
        self._digest = digest

    @property
    def cache_path(self) -> str:
        """Folder of the files."""
        return str(self._folder)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Compiled code of a signature, or None."""
        target_context.refresh()
        try:
            content = self._file(sig, target_context.codegen()).read_bytes()
            return self._implementation.rebuild(target_context, pickle.loads(content))
        # A file that is missing, cut short or of another make is as good as none.
        except Exception:
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code, if the disk allows."""
        if not self._implementation.check_cachable(data):
            return
        content = dumps(self._implementation.reduce(data))
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            handle, draft = tempfile.mkstemp(dir=self._folder)
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
            os.replace(draft, self._file(sig, data.codegen))
            self._prune()
        except OSError:
            return

    def _file(self, sig: Any, codegen: Any) -> Path:
        key = repr((self._digest, str(sig), codegen.magic_tuple())).encode()
        return self._folder / f"kernel-{hashlib.sha256(key).hexdigest()[:32]}.nbc"

    def _prune(self) -> None:
        files = sorted(self._folder.glob("kernel-*.nbc"), key=lambda path: path.stat().st_mtime)
        for old in files[:-KEPT]:
            old.unlink(missing_ok=True)

    def enable(self) -> None:
        """It always is."""

    def disable(self) -> None:
        """Nothing asks for it."""

    def flush(self) -> None:
        """Nothing asks for it."""
