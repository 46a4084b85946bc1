"""Plain loops as machine code; knows no physics.

`translation` turns plain functions over numbers, arrays and records into LLVM's text, one pass, no inference but that
of the arguments; `arithmetic` writes their operations, `kinds` says what a value is; `machine` optimises the text,
keeps the machine code on disk and calls it. Depends on: no room.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
