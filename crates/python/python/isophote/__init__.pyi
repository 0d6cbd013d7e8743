from collections.abc import Mapping
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

Renderer = Literal["raycast", "raster", "gpu"]
Side = Literal["front", "back", "top", "bottom", "left", "right", "iso"]
Vector = tuple[float, float, float]

class IsophoteError(Exception): ...
class ReadError(IsophoteError): ...
class CameraError(IsophoteError): ...
class RenderError(IsophoteError): ...
class EvalError(IsophoteError): ...
class GBufferError(IsophoteError): ...

@final
class Camera:
    def __new__(
        cls,
        *,
        view: Side | None = None,
        azimuth: float | None = None,
        elevation: float | None = None,
        zoom: float | None = None,
        eye: Vector | None = None,
        target: Vector | None = None,
        up: Vector | None = None,
        fov: float | None = None,
        ortho: float | None = None,
        near: float | None = None,
        lens_shift: tuple[float, float] | None = None,
    ) -> Camera: ...

@final
class Face:
    surface: int
    reversed: bool
    domain: tuple[tuple[float, float], tuple[float, float]]
    degree: tuple[int, int]
    loops: int
    name: str | None
    colour: str | None
    kind: str

@final
class GBuffer:
    hit: NDArray[np.uint8]
    face: NDArray[np.int32]
    u: NDArray[np.float64]
    v: NDArray[np.float64]
    span: NDArray[np.int32]
    local: NDArray[np.float64]
    t: NDArray[np.float64]
    pos: NDArray[np.float64]
    normal: NDArray[np.float64]
    status: NDArray[np.uint8]
    k1: NDArray[np.float64]
    k2: NDArray[np.float64]
    edge: NDArray[np.float64]
    undecided: NDArray[np.uint8]
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def covered(self) -> int: ...
    @property
    def meta(self) -> dict[str, Any]: ...
    def keys(self) -> list[str]: ...
    def arrays(self) -> dict[str, Any]: ...
    def write(self, path: str | PathLike[str]) -> None: ...
    def __getitem__(self, name: str) -> NDArray[Any]: ...
    @staticmethod
    def read(path: str | PathLike[str]) -> GBuffer: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> GBuffer: ...

@final
class Verdict:
    @property
    def agrees(self) -> bool: ...
    @property
    def exit_code(self) -> int: ...
    @property
    def line(self) -> str: ...
    @property
    def covered(self) -> int: ...
    @property
    def differ(self) -> int: ...
    @property
    def cause(self) -> str | None: ...
    @property
    def pairs(self) -> list[dict[str, Any]]: ...
    def __bool__(self) -> bool: ...

@final
class Model:
    @property
    def name(self) -> str: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def faces(self) -> list[Face]: ...
    def render(
        self,
        camera: Camera | None = None,
        size: tuple[int, int] = (512, 512),
        renderer: Renderer = "raycast",
        *,
        technique: str = "fragment",
        error: float = 0.25,
        edges: bool = False,
        adapter: str | None = None,
    ) -> GBuffer: ...
    def eval(self, face: int | NDArray[np.integer[Any]], uv: ArrayLike) -> dict[str, NDArray[Any]]: ...
    def rays(self, origins: ArrayLike, directions: ArrayLike, *, near: float = 0.0) -> dict[str, NDArray[Any]]: ...
    def judge(
        self,
        gbuffer: GBuffer,
        other: GBuffer | None = None,
        *,
        technique: str = "fragment",
        error: float = 0.25,
    ) -> Verdict: ...

def open(path: str | PathLike[str]) -> Model: ...
def gbuffer(arrays: Mapping[str, Any]) -> GBuffer: ...
def judge(
    gbuffer: GBuffer,
    other: GBuffer | None = None,
    *,
    model: Model | None = None,
    technique: str = "fragment",
    error: float = 0.25,
) -> Verdict: ...
