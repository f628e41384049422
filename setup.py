"""What pyproject.toml cannot say: a wheel has the pages of findings and the files that they share as one file."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

CODES = Path(__file__).resolve().parent / "docs" / "codes"
SHIPPED = {".md", ".toml", ".INI", ".MAC"}


class WithPages(build_py):
    """``gproof/docs_codes/pages.txt``: each file after a form feed and its name (report/finding_page.py reads it)."""

    def run(self) -> None:
        """Build, and write the pages; an editable installation reads those of the checkout."""
        super().run()
        if not self.editable_mode:
            made = self.bundle()
            made.parent.mkdir(parents=True, exist_ok=True)
            files = (path for path in sorted(CODES.rglob("*")) if path.suffix in SHIPPED)
            texts = (f"\f{path.relative_to(CODES).as_posix()}\n{path.read_text('utf-8')}" for path in files)
            made.write_text("".join(texts), "utf-8")

    def bundle(self) -> Path:
        """Where the pages go."""
        return Path(self.build_lib, "gproof", "docs_codes", "pages.txt")

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        """What was built."""
        return [*super().get_outputs(include_bytecode), *([] if self.editable_mode else [str(self.bundle())])]


setup(cmdclass={"build_py": WithPages})
