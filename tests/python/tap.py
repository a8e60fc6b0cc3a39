"""tap.py - run unittest cases and speak TAP.

Room:     tests/python.
Does:     one line a case, named without its "test_"; what failed follows as comments.
          Arguments are modules of this folder.
"""

import importlib
import sys
import traceback
import unittest
import warnings


class TapResult(unittest.TestResult):
    """Prints each result as soon as it is there."""

    def __init__(self):
        super().__init__()
        self.number = 0
        self.failed = 0
        self.told = None

    def say(self, test, good, comment="", log=""):
        name = str(test.id()).rsplit(".", 1)[-1].replace("test_", "", 1)
        if good and test is self.told:  # a subtest of it has failed already
            return
        self.told = test
        self.number += 1
        self.failed += not good
        print(f"{'ok' if good else 'not ok'} {self.number} - {name}{comment}")
        for line in log.splitlines():
            print("# " + line)
        sys.stdout.flush()

    def addSuccess(self, test):
        self.say(test, True)

    def addSkip(self, test, reason):
        self.say(test, True, " # SKIP " + reason)

    def addError(self, test, err):
        self.say(test, False, log="".join(traceback.format_exception(*err)))

    addFailure = addError

    def addSubTest(self, test, subtest, err):
        if err is not None:
            self.say(test, False, log=f"{subtest}\n" +
                     "".join(traceback.format_exception(*err)))


def main(names):
    result = TapResult()
    loader = unittest.defaultTestLoader
    warnings.simplefilter("error", ResourceWarning)
    # One suite: a second one would take down the last class of the first once more.
    unittest.TestSuite(loader.loadTestsFromModule(importlib.import_module(name))
                       for name in names).run(result)
    print(f"1..{result.number}")
    return 1 if result.failed or result.number == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
