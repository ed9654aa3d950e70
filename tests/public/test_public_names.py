"""Docstrings of public names cover every parameter and field, and their examples run with the output shown."""

from __future__ import annotations

import doctest
import inspect
import pkgutil
import re
import subprocess
import sys

import pytest

import granchain
import granchain_core
from granchain_core.former_names import present

NAMES = [name for name in granchain_core.__all__ if name != "__version__" and present(name) == name]
#: Names for figures and the dashboard, which the core does not have.
OWN = ["Dashboard", "dashboard", "figure"]
NAMES += OWN
FUNCTIONS = [name for name in NAMES if not isinstance(getattr(granchain, name), type)]


@pytest.mark.parametrize("name", NAMES)
def test_the_examples_of_a_public_name_run(name: str) -> None:
    subject = getattr(granchain, name)
    found = doctest.DocTestParser().get_doctest(inspect.cleandoc(subject.__doc__), {}, name, None, None)
    assert found.examples, f"{name} has no example"
    output: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    assert runner.run(found, out=output.append).failed == 0, "".join(output)


def section(name: str, title: str) -> str:
    """Return the text under a docstring heading, or an empty string if there is no such heading."""
    text = inspect.cleandoc(getattr(granchain, name).__doc__)
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^\w+\n-+$|\Z)", text, re.MULTILINE | re.DOTALL)
    return found[1] if found else ""


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_documents_every_parameter_and_what_it_returns(name: str) -> None:
    written = section(name, "Parameters")
    documented = {one.strip() for line in re.findall(r"^(\w[\w, ]*) :", written, re.MULTILINE) for one in line.split(",")}
    documented |= set(re.findall(r"^\*\*(\w+)$", written, re.MULTILINE))
    assert documented == set(inspect.signature(getattr(granchain, name)).parameters)
    assert section(name, "Returns") or section(name, "Yields")


@pytest.mark.parametrize("name", [name for name in NAMES if name not in FUNCTIONS])
def test_a_public_class_documents_its_fields(name: str) -> None:
    subject = getattr(granchain, name)
    written = section(name, "Attributes") + section(name, "Parameters")
    for field in getattr(subject, "__dataclass_fields__", {}):
        assert re.search(rf"^[\w, ]*\b{field}\b[\w, ]* :", written, re.MULTILINE), f"{name}.{field}"


def test_both_packages_have_the_same_names_but_for_pictures_and_dashboard() -> None:
    assert granchain.__all__ == [*granchain_core.__all__, *OWN] and granchain.__version__ == granchain_core.__version__
    assert all(getattr(granchain, name) is getattr(granchain_core, name) for name in granchain_core.__all__)
    assert set(granchain.__all__) <= set(dir(granchain))
    with pytest.raises(AttributeError, match="no attribute 'sceen'"):
        granchain.sceen  # noqa: B018


def alone(program: str) -> str:
    """Run a program in its own process and return what it prints."""
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=120).stdout


def test_importing_loads_no_compiler_and_no_file_library() -> None:
    """Importing these takes most of a second, and neither a page nor `granchain scenes` needs them immediately. Figures
    do not load Panel.
    """
    modules = "('numba', 'scipy', 'h5py', 'panel', 'bokeh')"
    assert alone(f"import sys, granchain; print([m for m in {modules} if m in sys.modules])") == "[]\n"
    assert alone("import sys, granchain; granchain.figure; from app.plots import any_result; print('panel' in sys.modules)") == "False\n"


def test_no_package_has_the_name_of_a_public_function() -> None:
    packages = {module.name for module in pkgutil.iter_modules(granchain_core.__path__) if module.ispkg}
    functions = {name for name in granchain_core.__all__ if inspect.isfunction(getattr(granchain_core, name))}
    # The function `scene` is bound when granchain_core is imported and stays bound: its package is not imported later.
    assert packages & functions == {"scene"}
