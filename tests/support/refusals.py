"""One law for all that makes no sense: the call ends in an error that says why."""

import pytest


def refuses(call, *rows, error=ValueError):
    """A test that a call is refused, for each row of what is passed and a part of the reason."""

    @pytest.mark.parametrize("row", rows, ids=[f"{n}: {row[-1]:.40}" for n, row in enumerate(rows)])
    def test(row):
        *given, reason = row
        with pytest.raises(error, match=reason):
            call(*given)

    return test
