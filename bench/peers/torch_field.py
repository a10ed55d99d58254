"""Trains a field in PyTorch. Runs inside the peer's environment: needs torch and NumPy only.

    python -m peers.torch_field TASK.npz        and requests on standard input, see field_worker.py

As good as plain PyTorch reasonably gets: all levels of a grid at once, gathers whose backward pass is
dense and in native code, Adam fused into one native call, no Python loop over samples, levels or
parameters. Formulations of each encoding that were slower are named where it stands, in torch_encodings.py.
"""

from __future__ import annotations

import sys

import numpy as np
import torch
from torch import Tensor, nn

from peers.field_worker import Side, Task, read_task, serve
from peers.torch_encodings import ENCODINGS

_ACTIVATIONS = {
    "relu": nn.functional.relu,
    "leaky_relu": lambda x: nn.functional.leaky_relu(x, 0.01),
    "silu": nn.functional.silu,
    "gelu": nn.functional.gelu,
    "sine": torch.sin,
}
_HEADS = {"exp": torch.exp, "softplus": nn.functional.softplus, "linear": lambda x: x}


class TorchField(nn.Module):
    """Encodings of position and normal, then a perceptron and its head."""

    def __init__(self, spec: dict, parameters: dict[str, np.ndarray]) -> None:
        super().__init__()
        self.position = _encoding(spec["position"], parameters.get("position"))
        self.direction = None
        if spec["direction"] is not None:
            self.direction = _encoding(spec["direction"], parameters.get("direction"))
        layers = []
        for i in range(spec["n_hidden_layers"] + 1):
            weight, bias = parameters[f"mlp.{i}.weight"], parameters[f"mlp.{i}.bias"]
            layer = nn.Linear(weight.shape[1], weight.shape[0])
            layer.weight = nn.Parameter(torch.from_numpy(weight.copy()))
            layer.bias = nn.Parameter(torch.from_numpy(bias.copy()))
            layers.append(layer)
        self.layers = nn.ModuleList(layers)
        self.activation = _ACTIVATIONS[spec["activation"]]
        self.head = _HEADS[spec["head"]]

    def forward(self, x: Tensor, normal: Tensor | None) -> Tensor:
        """Outputs (N, n_outputs)."""
        features = self.position(x)
        if self.direction is not None:
            features = torch.cat((features, self.direction(normal)), dim=1)
        for layer in self.layers[:-1]:
            features = self.activation(layer(features))
        return self.head(self.layers[-1](features))

    def named(self) -> dict[str, nn.Parameter]:
        """Parameters by the names that the task uses; encodings' in their own shapes."""
        named = {}
        for name, encoding in (("position", self.position), ("direction", self.direction)):
            for table in [] if encoding is None else encoding.parameters():
                named[name] = table
        for i, layer in enumerate(self.layers):
            named |= {f"mlp.{i}.weight": layer.weight, f"mlp.{i}.bias": layer.bias}
        return named


class TorchSide(Side):
    """The peer in the benchmark."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.device = torch.device(task.settings["device"])
        self.x = self._tensor(task.x)
        self.normal = None if task.normal is None else self._tensor(task.normal)
        self.target = self._tensor(task.target)

    def _tensor(self, array: np.ndarray) -> Tensor:
        return torch.from_numpy(array).to(self.device)

    def start(self) -> None:
        """Builds model and optimiser anew."""
        settings = self.task.settings
        self.field = TorchField(settings["spec"], self.task.parameters).to(self.device)
        self.field.position.own_backward = settings["own_backward"]
        self.loss = _LOSSES[settings["loss"]]
        tables = [p for name, p in self.field.named().items() if not name.startswith("mlp")]
        network = [p for name, p in self.field.named().items() if name.startswith("mlp")]
        groups = [
            _adam_group(tables, settings["encoding_adam"], settings["rates"]["encoding"]),
            _adam_group(network, settings["network_adam"], settings["rates"]["network"]),
        ]
        self.optimiser = torch.optim.Adam([g for g in groups if g["params"]], fused=True)
        self.average_decay = settings["average"]
        self.average = [p.detach().clone() for p in self.field.parameters()] if self.average_decay else []

    def step(self, batch: int) -> float:
        """Forward, backward, Adam, running mean where one is asked for."""
        self.optimiser.zero_grad(set_to_none=True)
        prediction = self.field(self.x[batch], self._normal(batch))
        loss = self.loss(prediction, self.target[batch])
        loss.backward()
        self.optimiser.step()
        if self.average:
            with torch.no_grad():
                parameters = list(self.field.parameters())
                torch._foreach_lerp_(self.average, parameters, 1.0 - self.average_decay)
        return loss.item()

    @torch.inference_mode()
    def infer(self, batch: int) -> np.ndarray:
        """Outputs of a batch."""
        return self.field(self.x[batch], self._normal(batch)).cpu().numpy()

    def state(self) -> dict[str, np.ndarray]:
        """Parameters and first moments, flat where the task's are."""
        flat = {"position": self.field.position, "direction": self.field.direction}
        found = {}
        for name, parameter in self.field.named().items():
            own = {name: parameter.detach(), f"first/{name}": self.optimiser.state[parameter]["exp_avg"]}
            for key, values in own.items():
                found[key] = (flat[name].flat(values) if name in flat else values).cpu().numpy()
        return found

    def version(self) -> str:
        """PyTorch's, and what it runs on."""
        where = torch.cuda.get_device_name(self.device) if self.device.type == "cuda" else "CPU"
        return f"PyTorch {torch.__version__} on {where}"

    def _normal(self, batch: int) -> Tensor | None:
        return None if self.normal is None else self.normal[batch]


def relative_l2(prediction: Tensor, target: Tensor) -> Tensor:
    """(p − t)² / (p² + 0.01), the denominator taken as constant (Lehtinen et al. 2018)."""
    return ((prediction - target).square() / (prediction.detach().square() + 0.01)).mean()


_LOSSES = {"relative_l2": relative_l2, "l2": nn.functional.mse_loss}


def _encoding(spec: dict, parameters: np.ndarray | None) -> nn.Module:
    options = {name: value for name, value in spec.items() if name != "type"}
    return ENCODINGS[spec["type"]](parameters, **options)


def _adam_group(parameters: list[nn.Parameter], adam: dict, rate: float) -> dict:
    return {
        "params": parameters,
        "lr": rate,
        "betas": (adam["beta1"], adam["beta2"]),
        "eps": adam["epsilon"],
    }


def main() -> None:
    """Reads the task and serves."""
    task = read_task(sys.argv[1])
    torch.set_num_threads(task.settings["threads"])
    serve(TorchSide(task), task.n_batches)


if __name__ == "__main__":
    main()
