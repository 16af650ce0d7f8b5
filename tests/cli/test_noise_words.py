import pytest

from fuzzytrack.cli.noise_words import noise_sentence
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import recording_files


@pytest.mark.parametrize(
    ("names", "said", "sentence"),
    [
        ("a_km,b_rad", {"polar": ("a_km", "b_rad")}, "a_km 30 m, b_rad 0.1 deg"),
        ("x,y", {"sigma": (1.0, 2.0)}, "x 1, y 2"),
        ("x,y", {"sigma": 2.0}, "2"),
        ("lat,lon", {"geodetic": ("lat", "lon"), "sigma": 5.0}, "5 m"),
        ("b,x", {"angle": "b", "sigma": 0.5}, "0.5 deg"),
        ("b_rad,x", {"angle": "b_rad", "sigma": 0.01}, "0.01 rad"),
        ("x,y", {}, ""),
    ],
)
def test_deviations_have_the_unit_of_the_plots(tmp_path, names, said, sentence):
    path = tmp_path / "plots.csv"
    path.write_text(f"t,{names}\n0,1,0\n1,2,0\n2,3,0\n")
    if "polar" in said:
        said = {**said, "sigma_range": 30.0, "sigma_azimuth": 0.1}
    files = PlotFiles.of(recording_files(path), Reading.of(**said))
    assert noise_sentence(files.surveyed()[0].decoder) == sentence
