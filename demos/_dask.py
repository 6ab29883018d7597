"""Joblib's Dask backend, made to stop when a run is lost, and to run on the smallest cluster."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from joblib._dask import DaskDistributedBackend


class DaskBackend(DaskDistributedBackend):
    """Tells joblib of the error, too, when Dask gives a run up."""

    def effective_n_jobs(self, n_jobs: int) -> int:
        # For a single one, joblib would run all here, and nothing on a cluster of one thread.
        return max(2, super().effective_n_jobs(n_jobs))

    def submit(
        self, func: Callable[..., Any], callback: Callable[[Any], None]
    ) -> Future[Any]:
        def done(future: Future[Any]) -> None:
            # Joblib 1.6 calls back only for results, and waits for the others for ever.
            if (error := future.exception()) is not None:
                callback(error)

        future = super().submit(func, callback)
        future.add_done_callback(done)
        return future

    def retrieve_result_callback(self, out: Any) -> Any:
        if isinstance(out, BaseException):
            raise out
        return super().retrieve_result_callback(out)
