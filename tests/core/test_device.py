"""The choice of device."""

from __future__ import annotations

import os

import pytest

from irradia.core import device
from irradia.core.errors import InputError, MissingDependencyError
from irradia.core.libllvm import VARIABLE


@pytest.fixture
def without_gpu(monkeypatch):
    monkeypatch.setattr(
        device, "cuda_status", lambda: device.CudaStatus(None, False, "no NVIDIA driver was found")
    )


@pytest.fixture
def with_gpu(monkeypatch):
    monkeypatch.setattr(device, "cuda_status", lambda: device.CudaStatus("Test GPU", True, ""))


def test_auto_takes_the_cpu_where_there_is_no_gpu(without_gpu):
    chosen = device.prepare("auto")
    assert chosen.kind == "cpu"
    assert chosen.libllvm is not None
    assert chosen.libllvm.is_file()
    assert chosen.name


def test_the_cpu_device_names_its_library_to_dr_jit(without_gpu):
    assert os.environ[VARIABLE] == str(device.prepare("cpu").libllvm)


def test_auto_takes_a_gpu_with_optix(with_gpu):
    chosen = device.prepare("auto")
    assert (chosen.kind, chosen.name, chosen.libllvm) == ("cuda", "Test GPU", None)


def test_cpu_stays_cpu_beside_a_gpu(with_gpu):
    assert device.prepare("cpu").kind == "cpu"


def test_cuda_without_a_driver_says_what_is_missing(without_gpu):
    with pytest.raises(MissingDependencyError, match="no NVIDIA driver") as caught:
        device.prepare("cuda")
    assert caught.value.exit_code == 2
    assert caught.value.fix == device.CUDA_FIX


def test_auto_falls_back_where_optix_is_missing(monkeypatch):
    monkeypatch.setattr(device, "cuda_status", lambda: device.CudaStatus("Test GPU", False, "no OptiX"))
    assert device.prepare("auto").kind == "cpu"


def test_a_missing_driver_library_is_reported(monkeypatch):
    monkeypatch.setattr(device, "_load", lambda library: None)
    assert device.cuda_status().problem == "no NVIDIA driver was found"


@pytest.mark.parametrize(("choice", "threads"), [("gpu", None), ("cpu", 0), ("cpu", -3)])
def test_a_wrong_choice_is_bad_input(choice, threads):
    with pytest.raises(InputError, match="expected"):
        device.prepare(choice, threads)


def test_threads_default_to_what_the_process_may_use():
    assert device.prepare("cpu").threads == device.available_threads() >= 1
    assert device.prepare("cpu", threads=3).threads == 3
