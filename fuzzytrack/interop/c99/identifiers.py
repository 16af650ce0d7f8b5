"""Names of rule bases and variables as identifiers of C."""

from __future__ import annotations

import re
import unicodedata

__all__ = ["SYSTEM_HEADERS", "Identifiers", "ascii_text", "c_identifier", "is_free_name"]

#: Words that mean something to a compiler of C or C++, or are macros of headers that programs for
#: small devices include.
_RESERVED = frozenset(
    re.findall(
        r"\S+",
        """
        auto break case char const continue default do double else enum extern float for goto if
        inline int long register restrict return short signed sizeof static struct switch typedef
        union unsigned void volatile while alignas alignof asm bool catch class const_cast constexpr
        decltype delete dynamic_cast explicit export false friend mutable namespace new noexcept
        nullptr operator private protected public reinterpret_cast static_assert static_cast
        template this thread_local throw true try typeid typename using virtual wchar_t and and_eq
        bitand bitor compl not not_eq or or_eq xor xor_eq concept requires char8_t char16_t char32_t
        co_await co_return co_yield consteval constinit typeof fortran linux unix i386 arm near far
        huge interrupt main errno assert offsetof va_arg va_end va_start setjmp isnan isinf isfinite
        isnormal signbit fpclassify stdin stdout stderr NULL EOF NAN INFINITY HUGE_VAL BUFSIZ
        RAND_MAX CHAR_BIT EXIT_SUCCESS EXIT_FAILURE EDOM ERANGE I complex imaginary __LINE__
        """,
    )
)
# Names that <stdint.h>, <float.h>, <limits.h>, <math.h> and <stdbool.h> define or reserve.
_HEADERS = re.compile(
    r"U?INT\d*_.*|U?INT_.*|U?INTMAX_.*|U?INTPTR_.*|(FLT|DBL|LDBL|SHRT|LONG|LLONG|CHAR|SCHAR|UCHAR)_.*"
    r"|U(INT|SHRT|LONG|LLONG)_MAX|FP_.*|M_\w+|(PTRDIFF|SIZE|WCHAR|WINT|SIG_ATOMIC)_.*|\w+_t|U?INT\w*_C"
)
#: Headers of C without ``.h``. A file of such a name beside them could be included in their place.
SYSTEM_HEADERS = frozenset(
    re.findall(
        r"\w+",
        """
        assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal
        stdarg stdbool stddef stdint stdio stdlib string tgmath time wchar wctype
        """,
    )
)
# Longer ones need not differ for all compilers.
_LENGTH = 31


def ascii_text(text: str) -> str:
    """Text in ASCII: letters without accents, Greek letters by name, other characters as ``?``."""
    words = []
    for character in unicodedata.normalize("NFKD", text):
        if character.isascii():
            words.append(character if character.isprintable() else " ")
        elif not unicodedata.combining(character):
            name = unicodedata.name(character, "")
            greek = re.fullmatch(r"GREEK (SMALL|CAPITAL) LETTER (?:FINAL )?(\w+)", name)
            if greek:
                words.append(greek[2].lower() if greek[1] == "SMALL" else greek[2].capitalize())
            else:
                words.append("-" if "DASH" in name or "MINUS" in name else "?")
    return "".join(words)


def c_identifier(text: str, otherwise: str = "x") -> str:
    """A name as an identifier of C that is no reserved word.

    Parameters
    ----------
    text : str
        Any text.
    otherwise : str
        Identifier for a text without letters and digits, and prefix of one that begins with a
        digit.

    Examples
    --------
    >>> c_identifier("stiffness-damping"), c_identifier("2 rules"), c_identifier("double")
    ('stiffness_damping', 'x_2_rules', 'double_')
    """
    word = re.sub(r"\W+", "_", ascii_text(text).replace("?", "_"), flags=re.ASCII).strip("_")
    word = re.sub(r"__+", "_", word)[:_LENGTH].rstrip("_") or otherwise
    if word[0].isdigit():
        word = f"{otherwise}_{word}"[:_LENGTH].rstrip("_")
    return f"{word}_" if word in _RESERVED or _HEADERS.fullmatch(word) else word


def is_free_name(name: str) -> bool:
    """Whether a text is an identifier of C that means nothing to compilers and headers.

    Of a long one that is judged by the characters in which all compilers tell names apart.
    """
    short = name[:_LENGTH].rstrip("_")
    return name.isidentifier() and short != "" and c_identifier(short) == short


class Identifiers:
    """Identifiers of one scope, each used once.

    Parameters
    ----------
    *taken : str
        Identifiers that are used already.
    """

    def __init__(self, *taken: str) -> None:
        self._taken = set(taken)

    def unique(self, text: str, otherwise: str = "x") -> str:
        """A name as an identifier that is not used in the scope yet; from now on it is."""
        word = c_identifier(text, otherwise)
        number = 2
        found = word
        while found in self._taken:
            found = f"{word.rstrip('_')}_{number}"
            number += 1
        self._taken.add(found)
        return found
