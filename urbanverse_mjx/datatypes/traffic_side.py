"""The side of the road on which a country's traffic drives.

Source: the `driveSide` of the features of country-coder (https://github.com/rapideditor/country-coder, ISC), the
borders that OpenStreetMap's editors use, as of 2026-04-29; names beside its own are those of ISO 3166-1 and usual ones.
"""

import re
import unicodedata

#: ISO 3166-1 codes (alpha-2, alpha-3) and English names of the countries and territories where traffic keeps left;
#: everywhere else it keeps right.
_KEEPS_LEFT = """
AC ASC Ascension Island
AG ATG Antigua and Barbuda
AI AIA Anguilla
AU AUS Australia
BB BRB Barbados
BD BGD Bangladesh
BM BMU Bermuda
BN BRN Brunei; Brunei Darussalam
BS BHS Bahamas
BT BTN Bhutan
BW BWA Botswana
CC CCK Cocos (Keeling) Islands; Cocos Islands; Keeling Islands
CK COK Cook Islands
CQ CRQ Sark
CX CXR Christmas Island
CY CYP Cyprus; Republic of Cyprus; Northern Cyprus; Akrotiri; Dhekelia; Akrotiri and Dhekelia
DM DMA Dominica
FJ FJI Fiji
FK FLK Falkland Islands
GB GBR United Kingdom; UK; Great Britain; Britain; England; Scotland; Wales; Northern Ireland
GD GRD Grenada
GG GGY Guernsey; Alderney
GS SGS South Georgia and South Sandwich Islands; South Georgia; South Georgia and the South Sandwich Islands
GY GUY Guyana
HK HKG Hong Kong
HM HMD Heard Island and McDonald Islands
ID IDN Indonesia
IE IRL Ireland; Republic of Ireland
IM IMN Isle of Man
IN IND India
JE JEY Jersey; Bailiwick of Jersey
JM JAM Jamaica
JP JPN Japan
KE KEN Kenya
KI KIR Kiribati
KN KNA Saint Kitts and Nevis
KY CYM Cayman Islands
LC LCA Saint Lucia
LK LKA Sri Lanka
LS LSO Lesotho
MO MAC Macau; Macao
MS MSR Montserrat
MT MLT Malta
MU MUS Mauritius
MV MDV Maldives
MW MWI Malawi
MY MYS Malaysia
MZ MOZ Mozambique
NA NAM Namibia
NF NFK Norfolk Island
NP NPL Nepal
NR NRU Nauru
NU NIU Niue
NZ NZL New Zealand; Aotearoa New Zealand
PG PNG Papua New Guinea
PK PAK Pakistan
PN PCN Pitcairn Islands; Pitcairn
SB SLB Solomon Islands
SC SYC Seychelles
SG SGP Singapore
SH SHN Saint Helena; Saint Helena, Ascension and Tristan da Cunha
SR SUR Suriname
SZ SWZ Eswatini; Swaziland
TA TAA Tristan da Cunha
TC TCA Turks and Caicos Islands
TH THA Thailand
TK TKL Tokelau
TL TLS East Timor; Timor-Leste
TO TON Tonga
TT TTO Trinidad and Tobago
TV TUV Tuvalu
TZ TZA Tanzania
UG UGA Uganda
VC VCT Saint Vincent and the Grenadines
VG VGB British Virgin Islands
VI VIR United States Virgin Islands; US Virgin Islands
WS WSM Samoa
ZA ZAF South Africa
ZM ZMB Zambia
ZW ZWE Zimbabwe
"""
#: What sources say where the country is not known.
_UNKNOWN = ("", "unknown", "none", "nowhere")


def _plain(name: str) -> str:
    """A name in lower case, without accents, punctuation and "the"."""
    ascii_name = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
    words = re.findall(r"[a-z0-9]+", ascii_name.replace("&", " and ").replace("st.", "saint ").replace(".", ""))
    return " ".join(word for word in words if word != "the")


def _left() -> frozenset[str]:
    names: set[str] = set()
    for line in _KEEPS_LEFT.strip().splitlines():
        two, three, others = line.split(" ", 2)
        names |= {two.lower(), three.lower(), *map(_plain, others.split(";"))}
    return frozenset(names)


_LEFT = _left()


def keeps_left(country: str) -> bool | None:
    """Whether traffic keeps left in a country.

    Args:
      country: its English name or its ISO 3166-1 code of two or three letters, in any case.

    Returns:
      None if the country is "" or "unknown"; False for every name that is not one of a country where traffic keeps
      left.
    """
    name = _plain(country)
    return None if name in _UNKNOWN else name in _LEFT
