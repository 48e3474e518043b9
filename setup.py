"""pip install . (Debian's packages for building: ./dev setup): builds the compiled part by CMake and installs the package dvi."""
import os
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).parent.resolve()


class CMakeBuild(build_ext):
    def run(self):
        build = Path(os.environ.get("DVI_BUILD", ROOT / "build/release"))
        options = ["-DDVI_PYTHON=ON", f"-DPYTHON_EXECUTABLE={sys.executable}"]
        subprocess.run(["cmake", "--preset", "release", "-B", build, *options], cwd=ROOT, check=True)
        subprocess.run(["cmake", "--build", build, "--target", "dvi_python"], check=True)
        target = Path(self.get_ext_fullpath("dvi._dvi")).parent
        target.mkdir(parents=True, exist_ok=True)
        for module in (build / "python/dvi").glob("_dvi*.so"):
            self.copy_file(str(module), str(target / module.name))


setup(
    name="dvi",
    version=re.search(r'"(.+)"', (ROOT / "src/dvi/core/version.h").read_text()).group(1),
    description="Removes traffic from recorded drives and fills the holes with pixels of other frames",
    license="Apache-2.0",
    packages=["dvi"],
    package_dir={"": "python"},
    package_data={"dvi": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("dvi._dvi", [])],
    cmdclass={"build_ext": CMakeBuild},
    install_requires=["numpy"],
    python_requires=">=3.9",
    entry_points={"console_scripts": ["dvi = dvi.__main__:main"]},
)
