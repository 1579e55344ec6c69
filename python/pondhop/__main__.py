"""Where the command line begins: ``pondhop`` and ``python -m pondhop``.

Importing the rest takes a quarter of a second. Nothing is imported here but what answers a signal in that time.
"""

from pondhop.documents.signals import answer_signals_at_once


def main() -> None:
    """Run the command line; from pondhop's first line on Ctrl-C and requests to end are answered in a line.

    Before that, while Python itself starts, it answers them in its own way.
    """
    answer_signals_at_once()
    from pondhop import cli

    cli.main()


if __name__ == "__main__":
    main()
