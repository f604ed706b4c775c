"""Kernels of notebooks that begin with all their imports done: each is a copy of one process."""

from __future__ import annotations

import multiprocessing
import os
import sys
from typing import Any
from uuid import uuid4

from jupyter_client.provisioning.local_provisioner import LocalProvisioner
from nbclient import NotebookClient

IMPORTED = (
    "ipykernel.kernelapp",
    "ipywidgets",
    "matplotlib.backends.backend_svg",
    "matplotlib.figure",
    "numba",
    "pandas",
    "percept_obs.exercises",
    "percept_obs.figures",
    "percept_obs.labs",
    "percept_obs.papers",
    "percept_obs.site.notebooks",
    "percept_obs.structure.competitors",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.signal",
    "xarray",
)
"""Modules that are there before a kernel begins; one that is not installed is left out."""


def client_of(notebook: Any, **options: Any) -> NotebookClient:
    """Client that runs a notebook; its kernel is a copy where the system makes copies of processes safely."""
    return (_Client if sys.platform == "linux" else NotebookClient)(notebook, **options)


class _Client(NotebookClient):
    def create_kernel_manager(self) -> Any:
        manager = super().create_kernel_manager()
        manager.kernel_id = str(uuid4())
        manager.provisioner = _Copied(kernel_id=manager.kernel_id, kernel_spec=manager.kernel_spec, parent=manager)
        return manager


class _Copied(LocalProvisioner):
    async def launch_kernel(self, cmd: list[str], **kwargs: Any) -> Any:
        manager: Any = self.parent
        process: Any = _Process(manager.connection_file, kwargs.get("cwd") or os.getcwd(), dict(kwargs["env"]))
        self.process, self.pid = process, process.pid
        return self.connection_info


class _Process:
    """A copy of the process that has imported all, as Jupyter asks for it."""

    stdin = stdout = stderr = None

    def __init__(self, *arguments: Any) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(list(IMPORTED))
        self._process = context.Process(target=_serve, args=arguments)
        self._process.start()
        self.pid = self._process.pid

    def poll(self) -> int | None:
        return self._process.exitcode

    def wait(self) -> int | None:
        self._process.join()
        return self._process.exitcode

    def send_signal(self, number: int) -> None:
        if self.pid and self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        self._process.kill()

    def terminate(self) -> None:
        self._process.terminate()


def _serve(connection: str, folder: str, environment: dict[str, str]) -> None:
    """Be the kernel that a file describes."""
    from ipykernel.kernelapp import IPKernelApp

    os.environ.update(environment)
    os.chdir(folder)
    IPKernelApp.launch_instance(argv=["-f", connection, f"--IPKernelApp.parent_handle={os.getppid()}"])
