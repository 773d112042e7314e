"""A bad attribute is refused when the model compiles, by name, value and range."""

import mujoco
import pytest

import mujoco_impact  # noqa: F401  registers the plugin

TEMPLATE = """
<mujoco>
  <extension>
    <plugin plugin="mujoco_impact.waveform">
      <instance name="impact">{config}</instance>
    </plugin>
  </extension>
  <option {option}/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body pos="0 0 1">
      <freejoint/><geom name="a" size=".1" margin="-.01" gap=".1"/>
    </body>
    <body pos="0 0 2">
      <freejoint/><geom name="b" size=".1" margin="-.01" gap=".1"/>
    </body>
    <body pos="0 0 3">
      <freejoint/><geom name="c" size=".1" margin="-.01" gap=".1"/>
    </body>
  </worldbody>
  <custom>
    <tuple name="impact">
      <element objtype="geom" objname="a"/>
      <element objtype="geom" objname="b"/>
      <element objtype="{third}" objname="{third_name}"/>
    </tuple>
  </custom>
</mujoco>
"""

CALIBRATED = {"law": "calibrated", "alpha": "1 1", "sh": "190"}


def compile_with(config, option="", third=("geom", "c")):
    lines = "".join(f'<config key="{k}" value="{v}"/>' for k, v in config.items())
    return mujoco.MjModel.from_xml_string(
        TEMPLATE.format(
            config=lines, option=option, third=third[0], third_name=third[1]
        )
    )


@pytest.mark.parametrize(
    ("config", "name", "allowed"),
    [
        ({"law": "hooke"}, "law", "'hertz' or 'calibrated'"),
        ({"young": "-1"}, "young", "> 0 [Pa]"),
        ({"young": "nan"}, "young", "> 0 [Pa]"),
        ({"young": "2e11x"}, "young", "> 0 [Pa]"),
        ({"young": "1 2"}, "young", "> 0 [Pa]"),
        ({"poisson": "0.6"}, "poisson", "(-1, 0.5]"),
        ({"restitution": "1.1"}, "restitution", "[0, 1]"),
        ({"restitution": "inf"}, "restitution", "[0, 1]"),
        ({"dissipation": "none"}, "dissipation", "'bistiffness' or 'viscous'"),
        ({"dissipation": "viscous", "restitution": "0"}, "restitution", "[0.05, 1]"),
        ({"duration": "long"}, "duration", "'hertz', 'paper' or"),
        ({"duration": "0"}, "duration", "> 0 [s]"),
        ({"touch": "-1e-9"}, "touch", "[0, 1e-3] [m]"),
        ({"touch": "0.01"}, "touch", "[0, 1e-3] [m]"),
        ({"tolerance": "0"}, "tolerance", "[1e-12, 1e-2]"),
        ({"tolerance": "0.1"}, "tolerance", "[1e-12, 1e-2]"),
        ({"passive": "yes"}, "passive", "'true' or 'false'"),
        ({"alpha": "1 1"}, "alpha", "law = 'calibrated'"),
        (CALIBRATED | {"alpha": "1 1 1"}, "alpha", "3 given, 2 needed"),
        (CALIBRATED | {"alpha": ""}, "alpha", "0 given, 2 needed"),
        (CALIBRATED | {"alpha": "1 x"}, "alpha", "one number in [0, 1e25]"),
        (CALIBRATED | {"alpha": "1 -1"}, "alpha", "one number in [0, 1e25]"),
        (CALIBRATED | {"alpha": "1 1e26"}, "alpha", "one number in [0, 1e25]"),
        ({"law": "calibrated", "alpha": "1 1"}, "sh", "(0, 1e25]"),
        (CALIBRATED | {"sh": "0"}, "sh", "(0, 1e25]"),
        (CALIBRATED | {"sh": "1e26"}, "sh", "(0, 1e25]"),
        (CALIBRATED | {"sw": "-1"}, "sw", "[0, 1e25]"),
        (CALIBRATED | {"sw": "1e300"}, "sw", "[0, 1e25]"),
        (CALIBRATED | {"w0": "0"}, "w0", "(0, 1e25] [s]"),
        (CALIBRATED | {"w0": "1e300"}, "w0", "(0, 1e25] [s]"),
        (CALIBRATED | {"kappa": "-1"}, "kappa", "[0, 1e25]"),
        (CALIBRATED | {"kappa": "1e300"}, "kappa", "[0, 1e25]"),
        (CALIBRATED | {"e": "2"}, "e", "[0, 1]"),
        (CALIBRATED | {"friction": "coulomb"}, "friction", "with law = 'calibrated'"),
        ({"friction": "rolling"}, "friction", "'coulomb', 'none' or 'paper'"),
        ({"friction": "paper", "mu_d": "0.1"}, "mu_s", "needs it"),
        ({"friction": "paper", "mu_s": "0.1"}, "mu_d", "needs it"),
        ({"friction": "paper", "mu_s": "-1", "mu_d": "0"}, "mu_s", ">= 0"),
        ({"friction": "paper", "mu_s": "0", "mu_d": "inf"}, "mu_d", ">= 0"),
        ({"mu_s": "0.1"}, "mu_s", "friction = 'paper'"),
        ({"materials": "a restitution=1.1"}, "materials", "a number in [0, 1]"),
        ({"materials": "a restitution_loss=-1"}, "materials", ">= 0 [(s/m)^(1/5)]"),
        ({"materials": "a young=0"}, "materials", "> 0 [Pa]"),
        ({"materials": "a poisson=.6"}, "materials", "(-1, 0.5]"),
        ({"materials": "a friction=x"}, "materials", "a finite number >= 0"),
        ({"materials": "a colour=red"}, "materials", "'colour', must be restitution"),
        ({"materials": "a young"}, "materials", "'young', must be restitution"),
        ({"materials": "young=1e9"}, "materials", "a name first"),
        ({"materials": "a; b; a"}, "materials", "'a' must have one entry"),
        (
            {"materials": "a restitution=1 restitution_loss=.1"},
            "materials",
            "only one of restitution",
        ),
        *(
            ({"materials": f"a restitution_table={table}"}, "materials", "1 to 16")
            for table in (
                "",
                "1",
                "1:2",
                "-1:.5",
                "1:.5,1:.4",
                "1:x",
                ",".join(f"{u}:1" for u in range(17)),
            )
        ),
        (
            {"materials": "a restitution=.04", "dissipation": "viscous"},
            "materials",
            "[0.05, 1]",
        ),
        (CALIBRATED | {"materials": "a"}, "materials", "only with law = 'hertz'"),
        ({"material_pairs": "a b friction=1"}, "material_pairs", "'a' is none of"),
        (
            {"materials": "a; b", "material_pairs": "a b; b a"},
            "material_pairs",
            "one entry of the pair",
        ),
        (
            {"materials": "a; b", "material_pairs": "a restitution=.5"},
            "material_pairs",
            "a name first",
        ),
        (
            {"materials": "a; b", "material_pairs": "a b young=1"},
            "material_pairs",
            "friction or modulus",
        ),
    ],
)
def test_refused_with_attribute_value_and_what_is_allowed(config, name, allowed):
    with pytest.raises(ValueError, match=f"attribute '{name}' = ") as refusal:
        compile_with(config)
    value = config.get(name, "")
    assert f"'{name}' = '{value}'" in str(refusal.value)
    assert allowed in str(refusal.value)


def test_a_long_value_leaves_room_for_what_is_allowed():
    with pytest.raises(ValueError, match="attribute 'young' = ") as refusal:
        compile_with({"young": "9" * 2000})
    assert "999..." in str(refusal.value)
    assert "a finite number > 0 [Pa]" in str(refusal.value)


@pytest.mark.parametrize(
    "config",
    [
        {},
        {"law": "hertz", "restitution": "0", "young": "1e5", "poisson": "0.5"},
        {"dissipation": "viscous", "restitution": "0.05"},
        {"duration": "paper", "w0": "7.5e-3", "sw": "0.5", "kappa": "1"},
        {"duration": "7.5e-3", "touch": "0", "passive": "false"},
        CALIBRATED | {"sw": "0.4", "e": "0.5", "duration": "hertz"},
        {"materials": ""},
        {"materials": ";; a ; b young=1 friction=0;", "material_pairs": "b a; b b;"},
        {"materials": "a restitution_table=0:1,1e-1:.9,2:0 poisson=-0.5"},
    ],
)
def test_good_settings_compile(config):
    assert compile_with(config).nplugin == 1


def test_an_unknown_attribute_is_refused():
    with pytest.raises(ValueError, match="unrecognized attribute"):
        compile_with({"stiffness": "1"})


def test_a_tuple_of_something_else_is_refused():
    with pytest.raises(ValueError, match="geoms only"):
        compile_with({}, third=("body", "world"))


@pytest.mark.parametrize("materials", ["", "x; y"])
@pytest.mark.parametrize("number", ["3", "-3", "0.5"])
def test_a_geom_of_no_known_material_is_refused(number, materials):
    xml = TEMPLATE.format(
        config=f'<config key="materials" value="{materials}"/>',
        option="",
        third="geom",
        third_name=f'c" prm="{number}',
    )
    count = 2 if materials else 0
    reason = (
        rf"number \(prm\) of geom 'c' in the tuple 'impact' is {number}, and the "
        f"instance has {count} materials; allowed: whole numbers up to that"
    )
    with pytest.raises(ValueError, match=reason):
        mujoco.MjModel.from_xml_string(xml)


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        (1, 2, "once of 'x' and once of 'y'"),
        (2, 1, "once of 'y' and once of 'x'"),
        (0, -2, "once of no material and once of 'y'"),
        (0, 0, "once of no material and once of no material"),
    ],
)
def test_a_geom_is_named_once_in_a_tuple(first, second, told):
    """Which of two materials it has would depend on their order."""
    xml = TEMPLATE.format(
        config='<config key="materials" value="x; y"/>',
        option="",
        third="geom",
        third_name=f'b" prm="{second}',
    ).replace('objname="b"/>', f'objname="b" prm="{first}"/>', 1)
    reason = f"geom 'b' is named twice in the tuple 'impact', {told}"
    with pytest.raises(ValueError, match=reason):
        mujoco.MjModel.from_xml_string(xml)


def test_geoms_that_are_not_owned_come_last():
    xml = TEMPLATE.format(
        config='<config key="materials" value="x"/>',
        option="",
        third="geom",
        third_name="c",
    )
    xml = xml.replace('objname="b"', 'objname="b" prm="-1"')
    with pytest.raises(ValueError, match=r"'c' in the tuple .* come last"):
        mujoco.MjModel.from_xml_string(xml)


def test_materials_without_a_tuple_are_refused():
    xml = TEMPLATE.format(
        config='<config key="materials" value="x"/>',
        option="",
        third="geom",
        third_name="c",
    ).replace('tuple name="impact"', 'tuple name="another"')
    with pytest.raises(ValueError, match="no tuple of its name says which geoms"):
        mujoco.MjModel.from_xml_string(xml)


@pytest.mark.parametrize(
    ("flags", "word"),
    [
        ('<flag spring="disable" damper="disable"/>', "passive forces are off"),
        ('<flag override="enable"/>', "override"),
    ],
)
def test_options_that_would_silence_the_plugin_are_refused(flags, word):
    xml = TEMPLATE.format(config="", option="", third="geom", third_name="c")
    with pytest.raises(ValueError, match=word):
        mujoco.MjModel.from_xml_string(
            xml.replace("<option />", f"<option>{flags}</option>")
        )
