"""The literature behind laws, codes, measures and methods, as data, as text and as BibTeX."""

from __future__ import annotations

from dataclasses import dataclass

from pounding_cli import __version__


@dataclass(frozen=True)
class Reference:
    """One entry.

    key : its BibTeX key, the first author's family name and the year
    kind : its BibTeX type
    authors : "Family, A. B. & Family, C."; of an organisation its name
    year : of publication
    title : without the final full stop
    place : BibTeX field and value of where it appeared, in the order they are printed
    """

    key: str
    kind: str
    authors: str
    year: int
    title: str
    place: tuple[tuple[str, str], ...] = ()

    @property
    def text(self) -> str:
        """The entry on one line."""
        at = dict(self.place)
        edition = f", {at['edition']} edition" if "edition" in at else ""
        volume = f" {at['volume']}" + (f"({at['number']})" if "number" in at else "") if "volume" in at else ""
        within = at.get("journal") or at.get("booktitle") or at.get("howpublished")
        where = [within + volume] if within else []
        where += [at[name].replace("--", "-") for name in ("pages", "publisher", "address") if name in at]
        doi = f" doi:{at['doi']}" if "doi" in at else ""
        return f"{self.authors} ({self.year}). {self.title}{edition}. {', '.join(where)}.{doi}"

    @property
    def bibtex(self) -> str:
        """The entry for a .bib file (UTF-8)."""
        people = self.authors.replace(" & ", " and ").replace("., ", ". and ")
        fields = [
            ("author", f"{{{self.authors}}}" if self.kind in ("manual", "software") else people),
            ("title", f"{{{self.title}}}"),
            ("year", str(self.year)),
            *self.place,
        ]
        lines = [f"  {name} = {{{value if name == 'doi' else _escaped(value)}}}" for name, value in fields]
        return "@{}{{{},\n{}\n}}".format(self.kind, self.key, ",\n".join(lines))


def _escaped(value: str) -> str:
    for sign in "&%#_":
        value = value.replace(sign, f"\\{sign}")
    return value


def _article(key: str, authors: str, year: int, title: str, journal: str, volume: str, pages: str = "", doi: str = ""):
    volume, _, number = volume.rstrip(")").partition("(")
    place = {"journal": journal, "volume": volume, "number": number, "pages": pages, "doi": doi}
    return Reference(key, "article", authors, year, title, tuple(item for item in place.items() if item[1]))


_EESD = "Earthquake Engineering & Structural Dynamics"

PROGRAM = Reference(
    "pounding_cli", "software", "pounding_cli contributors", 2026,
    "pounding_cli: batch studies of earthquake pounding between adjacent buildings",
    (("version", __version__), ("howpublished", f"Computer program, version {__version__}")),
)  # fmt: skip
PAPER = Reference(
    "spiliopoulos1996", "inproceedings", "Spiliopoulos, K. V. & Anagnostopoulos, S. A.", 1996,
    "Measures against earthquake pounding between adjacent buildings",
    (("booktitle", "Proceedings of the Eleventh World Conference on Earthquake Engineering"), ("address", "Acapulco")),
)  # fmt: skip

REFERENCES = {
    reference.key: reference
    for reference in (
        PROGRAM,
        PAPER,
        _article(
            "anagnostopoulos1988", "Anagnostopoulos, S. A.", 1988,
            "Pounding of buildings in series during earthquakes", _EESD, "16(3)", "443--456", "10.1002/eqe.4290160311",
        ),
        _article(
            "anagnostopoulos1992", "Anagnostopoulos, S. A. & Spiliopoulos, K. V.", 1992,
            "An investigation of earthquake induced pounding between adjacent buildings", _EESD, "21(4)", "289--302",
            "10.1002/eqe.4290210402",
        ),
        _article(
            "muthukumar2006", "Muthukumar, S. & DesRoches, R.", 2006,
            "A Hertz contact model with non-linear damping for pounding simulation", _EESD, "35(7)", "811--828",
            "10.1002/eqe.557",
        ),
        _article(
            "jankowski2005", "Jankowski, R.", 2005,
            "Non-linear viscoelastic modelling of earthquake-induced structural pounding", _EESD, "34(6)", "595--611",
            "10.1002/eqe.434",
        ),
        _article(
            "jankowski2006", "Jankowski, R.", 2006,
            "Analytical expression between the impact damping ratio and the coefficient of restitution in the "
            "non-linear viscoelastic model of structural pounding", _EESD, "35(4)", "517--524", "10.1002/eqe.537",
        ),
        _article(
            "zhang2000", "Zhang, W. S. & Xu, Y. L.", 2000,
            "Vibration analysis of two buildings linked by Maxwell model-defined fluid dampers",
            "Journal of Sound and Vibration", "233(5)", "775--796", "10.1006/jsvi.1999.2735",
        ),
        _article(
            "lin2002", "Lin, W.-H. & Chopra, A. K.", 2002,
            "Earthquake response of elastic SDF systems with non-linear fluid viscous dampers", _EESD, "31(9)",
            "1623--1642", "10.1002/eqe.179",
        ),
        _article(
            "pall1982", "Pall, A. S. & Marsh, C.", 1982,
            "Response of friction damped braced frames", "Journal of the Structural Division, ASCE", "108(6)",
            "1313--1323",
        ),
        _article(
            "bhaskararao2006", "Bhaskararao, A. V. & Jangid, R. S.", 2006,
            "Seismic analysis of structures connected with friction dampers", "Engineering Structures", "28(5)",
            "690--703", "10.1016/j.engstruct.2005.09.020",
        ),
        _article(
            "ye2009", "Ye, K., Li, L. & Zhu, H.", 2009,
            "A note on the Hertz contact model with nonlinear damping for pounding simulation", _EESD, "38",
            "1135--1142", "10.1002/eqe.883",
        ),
        Reference(
            "clough1966", "inproceedings", "Clough, R. W. & Johnston, S. B.", 1966,
            "Effect of stiffness degradation on earthquake ductility requirements",
            (("booktitle", "Proceedings of the Second Japan National Conference on Earthquake Engineering"),
             ("pages", "227--232"), ("address", "Tokyo")),
        ),
        Reference(
            "bouc1967", "inproceedings", "Bouc, R.", 1967,
            "Forced vibration of mechanical systems with hysteresis",
            (("booktitle", "Proceedings of the Fourth Conference on Nonlinear Oscillations"), ("address", "Prague")),
        ),
        _article(
            "wen1976", "Wen, Y.-K.", 1976,
            "Method for random vibration of hysteretic systems",
            "Journal of the Engineering Mechanics Division, ASCE", "102(2)", "249--263", "10.1061/JMCEA3.0002106",
        ),
        _article(
            "ibarra2005", "Ibarra, L. F., Medina, R. A. & Krawinkler, H.", 2005,
            "Hysteretic models that incorporate strength and stiffness deterioration", _EESD, "34(12)", "1489--1511",
            "10.1002/eqe.495",
        ),
        _article(
            "jeng1992", "Jeng, V., Kasai, K. & Maison, B. F.", 1992,
            "A spectral difference method to estimate building separations to avoid pounding", "Earthquake Spectra",
            "8(2)", "201--223", "10.1193/1.1585679",
        ),
        _article(
            "derkiureghian1981", "Der Kiureghian, A.", 1981,
            "A response spectrum method for random vibration analysis of MDF systems", _EESD, "9(5)", "419--435",
            "10.1002/eqe.4290090503",
        ),
        _article(
            "baker2015", "Baker, J. W.", 2015,
            "Efficient analytical fragility function fitting using dynamic structural analysis", "Earthquake Spectra",
            "31(1)", "579--599", "10.1193/021113EQS025M",
        ),
        _article(
            "vamvatsikos2004", "Vamvatsikos, D. & Cornell, C. A.", 2004,
            "Applied incremental dynamic analysis", "Earthquake Spectra", "20(2)", "523--553", "10.1193/1.1737737",
        ),
        _article(
            "jalayer2015", "Jalayer, F., De Risi, R. & Manfredi, G.", 2015,
            "Bayesian Cloud Analysis: efficient structural fragility assessment using linear regression",
            "Bulletin of Earthquake Engineering", "13(4)", "1183--1203", "10.1007/s10518-014-9692-z",
        ),
        Reference(
            "efron1993", "book", "Efron, B. & Tibshirani, R. J.", 1993, "An introduction to the bootstrap",
            (("publisher", "Chapman & Hall"), ("address", "New York")),
        ),
        _article(
            "saltelli2010", "Saltelli, A., Annoni, P., Azzini, I., Campolongo, F., Ratto, M. & Tarantola, S.", 2010,
            "Variance based sensitivity analysis of model output. Design and estimator for the total sensitivity index",
            "Computer Physics Communications", "181(2)", "259--270", "10.1016/j.cpc.2009.09.018",
        ),
        _article(
            "campolongo2007", "Campolongo, F., Cariboni, J. & Saltelli, A.", 2007,
            "An effective screening design for sensitivity analysis of large models",
            "Environmental Modelling & Software", "22(10)", "1509--1518", "10.1016/j.envsoft.2006.10.004",
        ),
        _article(
            "iwanaga2022", "Iwanaga, T., Usher, W. & Herman, J.", 2022,
            "Toward SALib 2.0: advancing the accessibility and interpretability of global sensitivity analyses",
            "Socio-Environmental Systems Modelling", "4", "18155", "10.18174/sesmo.18155",
        ),
        _article(
            "storn1997", "Storn, R. & Price, K.", 1997,
            "Differential evolution - a simple and efficient heuristic for global optimization over continuous spaces",
            "Journal of Global Optimization", "11(4)", "341--359", "10.1023/A:1008202821328",
        ),
        _article(
            "nelder1965", "Nelder, J. A. & Mead, R.", 1965,
            "A simplex method for function minimization", "The Computer Journal", "7(4)", "308--313",
            "10.1093/comjnl/7.4.308",
        ),
        Reference(
            "asce2017", "manual", "American Society of Civil Engineers", 2017,
            "Minimum design loads and associated criteria for buildings and other structures, ASCE/SEI 7-16",
            (("address", "Reston, Virginia"),),
        ),
        Reference(
            "en1998", "manual", "European Committee for Standardization", 2004,
            "EN 1998-1:2004, Eurocode 8: Design of structures for earthquake resistance - Part 1: General rules, "
            "seismic actions and rules for buildings",
            (("address", "Brussels"),),
        ),
        Reference(
            "gb50011-2010", "manual",
            "Ministry of Housing and Urban-Rural Development of the People's Republic of China", 2010,
            "Code for seismic design of buildings, GB 50011-2010",
            (("publisher", "China Architecture & Building Press"), ("address", "Beijing")),
        ),
        _article(  # the paper cites author and year; title and volume found nowhere else, so pages and DOI left out
            "westermo1989", "Westermo, B. D.", 1989,
            "The dynamics of interstructural connection to prevent pounding", _EESD, "18(5)",
        ),
        *(
            Reference(
                f"ubc{edition}", "manual", "International Conference of Building Officials", edition,
                "Uniform Building Code", (("edition", str(edition)), ("address", "Whittier, California")),
            )
            for edition in (1985, 1988, 1991, 1994)
        ),
        Reference(
            "arias1970", "incollection", "Arias, A.", 1970, "A measure of earthquake intensity",
            (("booktitle", "Seismic Design for Nuclear Power Plants (ed. R. J. Hansen)"), ("publisher", "MIT Press"),
             ("pages", "438--483"), ("address", "Cambridge, Massachusetts")),
        ),
        Reference(  # authors, year and subject as others cite them; volume and pages not confirmed, so left out
            "lilhanand1988", "inproceedings", "Lilhanand, K. & Tseng, W. S.", 1988,
            "Development and application of realistic earthquake time histories compatible with multiple-damping "
            "design spectra",
            (("booktitle", "Proceedings of the Ninth World Conference on Earthquake Engineering"),
             ("address", "Tokyo")),
        ),
        _article(
            "jorba2005", "Jorba, À. & Zou, M.", 2005,
            "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
            "Experimental Mathematics", "14(1)", "99--117", "10.1080/10586458.2005.10128904",
        ),
        _article(
            "newmark1959", "Newmark, N. M.", 1959, "A method of computation for structural dynamics",
            "Journal of the Engineering Mechanics Division, ASCE", "85(3)", "67--94", "10.1061/JMCEA3.0000098",
        ),
        _article(
            "wood1980", "Wood, W. L., Bossak, M. & Zienkiewicz, O. C.", 1980,
            "An alpha modification of Newmark's method",
            "International Journal for Numerical Methods in Engineering", "15(10)", "1562--1566",
            "10.1002/nme.1620151011",
        ),
        _article(
            "gustafsson2020", "Gustafsson, T. & McBain, G. D.", 2020,
            "scikit-fem: A Python package for finite element assembly", "Journal of Open Source Software", "5(52)",
            "2369", "10.21105/joss.02369",
        ),
    )
}  # fmt: skip


def named_in(source: str) -> list[Reference]:
    """The references whose first author and year a citation names."""
    names = {key: reference.authors.split(",")[0] for key, reference in REFERENCES.items()}
    return [ref for key, ref in REFERENCES.items() if f"{names[key]}," in source and f"({ref.year})" in source]
