"""What tests of commands share."""

import pytest

from squealbox.cli import main


@pytest.fixture
def said(capsys):
    """Run the words of a command; gives exit code, stdout and stderr."""

    def run(*words):
        code = main([str(word) for word in words])
        out, err = capsys.readouterr()
        assert "Traceback" not in err
        return code, out, err

    return run


@pytest.fixture
def brake(tmp_path, capsys):
    """The file that `init` writes."""
    assert main(["init", str(tmp_path / "brake")]) == 0
    capsys.readouterr()
    return tmp_path / "brake" / "brake.toml"
