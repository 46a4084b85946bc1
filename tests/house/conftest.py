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
