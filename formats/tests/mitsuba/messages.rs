//! What an author is told, word for word.

use insta::assert_snapshot;

use crate::{failure, failure_with, warnings};

#[test]
fn unknown_plugin() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <shape type='spher'/>\n</scene>"), @r#"
    error: unknown shape plugin `spher`
      ┌─ scene.xml:2:16
      │
    2 │   <shape type='spher'/>
      │                ^^^^^
      │
      = help: with --lenient it is skipped
      = help: did you mean `sphere`?
    "#);
}

#[test]
fn misspelt_parameter() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <shape type='sphere'>\n    <float name='radus' value='2'/>\n  </shape>\n</scene>"), @r#"
    error: unknown parameter `radus` of sphere
      ┌─ scene.xml:3:18
      │
    3 │     <float name='radus' value='2'/>
      │                  ^^^^^
      │
      = help: did you mean `radius`?
    "#);
    assert_snapshot!(warnings("<scene version='0.6.0'>\n  <integrator type='path'>\n    <integer name='maxDepht' value='2'/>\n  </integrator>\n</scene>", false), @r#"
    warning: unknown parameter `maxDepht` of path is ignored
      ┌─ scene.xml:3:20
      │
    3 │     <integer name='maxDepht' value='2'/>
      │                    ^^^^^^^^
      │
      = help: did you mean `maxDepth`?
    "#);
}

#[test]
fn missing_mesh() {
    assert_snapshot!(failure_with(
        "<scene version='3.0.0'>\n  <path value='assets'/>\n  <shape type='obj'>\n    <string name='filename' value='bunny.obj'/>\n  </shape>\n</scene>",
        &[],
        &[],
    ), @r#"
    error: mesh `bunny.obj` not found
      ┌─ scene.xml:4:36
      │
    4 │     <string name='filename' value='bunny.obj'/>
      │                                    ^^^^^^^^^
      │
      = help: searched in: assets, .
    "#);
}

#[test]
fn wrong_case_of_a_file_name() {
    assert_snapshot!(failure_with(
        "<scene version='3.0.0'>\n  <shape type='obj'>\n    <string name='filename' value='Meshes/Bunny.OBJ'/>\n  </shape>\n</scene>",
        &[("meshes/bunny.obj", "")],
        &[],
    ), @r#"
    error: mesh `Meshes/Bunny.OBJ` not found
      ┌─ scene.xml:3:36
      │
    3 │     <string name='filename' value='Meshes/Bunny.OBJ'/>
      │                                    ^^^^^^^^^^^^^^^^
      │
      = help: there is `meshes/bunny.obj`; upper and lower case matter
    "#);
}

#[test]
fn malformed_xml() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <shape type='sphere'>\n  </bsdf>\n</scene>"), @r#"
    error: mismatched end tag </bsdf>, expected </shape>
      ┌─ scene.xml:3:3
      │
    2 │   <shape type='sphere'>
      │    ----- <shape> begins here
    3 │   </bsdf>
      │   ^^^^^^^
    "#);
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <shape type='sphere'>"), @r#"
    error: <shape> is never closed
      ┌─ scene.xml:2:4
      │
    2 │   <shape type='sphere'>
      │    ^^^^^
    "#);
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <shape type='sphere' <"), @r#"
    error: malformed XML: syntax error: tag not closed: `>` not found before end of input
      ┌─ scene.xml:2:3
      │
    2 │   <shape type='sphere' <
      │   ^
    "#);
    assert_snapshot!(failure(""), @r#"
    error: the file contains no element
      ┌─ scene.xml:1:1
      │
    1 │
      │ ^
    "#);
    assert_snapshot!(failure("<!DOCTYPE a [<!ENTITY b 'c'>]>\n<scene version='3.0.0'/>"), @r#"
    error: a document type may not define entities
      ┌─ scene.xml:1:1
      │
    1 │ <!DOCTYPE a [<!ENTITY b 'c'>]>
      │ ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
    "#);
    assert_snapshot!(failure("<scene version='3.0.0'/>\n<scene version='3.0.0'/>"), @r#"
    error: a file may have only one root element; this is a second one
      ┌─ scene.xml:2:1
      │
    1 │ <scene version='3.0.0'/>
      │  ----- the root
    2 │ <scene version='3.0.0'/>
      │ ^^^^^^^^^^^^^^^^^^^^^^^^
    "#);
}

#[test]
fn wrong_root() {
    assert_snapshot!(failure("<bsdf type='diffuse' version='3.0.0'/>"), @r#"
    error: a scene file begins with <scene>, not <bsdf>
      ┌─ scene.xml:1:2
      │
    1 │ <bsdf type='diffuse' version='3.0.0'/>
      │  ^^^^
      │
      = help: a single object can only be included by a scene
    "#);
}

#[test]
fn include_cycle() {
    assert_snapshot!(failure_with(
        "<scene version='3.0.0'>\n  <include filename='a.xml'/>\n</scene>",
        &[("a.xml", "<scene version='3.0.0'>\n  <include filename='b.xml'/>\n</scene>"), ("b.xml", "<scene version='3.0.0'>\n  <include filename='a.xml'/>\n</scene>")],
        &[],
    ), @r#"
    error: include cycle: a.xml → b.xml → a.xml
      ┌─ b.xml:2:22
      │
    2 │   <include filename='a.xml'/>
      │                      ^^^^^
      │
      ┌─ a.xml:2:22
      │
    2 │   <include filename='b.xml'/>
      │                      ----- through this
    "#);
}

#[test]
fn unresolved_reference() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <bsdf type='diffuse' id='white'/>\n  <shape type='cube'>\n    <ref id='whiet'/>\n  </shape>\n</scene>"), @r#"
    error: no object has the id `whiet`
      ┌─ scene.xml:4:14
      │
    4 │     <ref id='whiet'/>
      │              ^^^^^
      │
      = help: did you mean `white`?
    "#);
}

#[test]
fn reference_cycle() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <bsdf type='twosided' id='a'>\n    <ref id='b'/>\n  </bsdf>\n  <bsdf type='mask' id='b'>\n    <ref id='a'/>\n  </bsdf>\n</scene>"), @r#"
    error: objects contain themselves: `a` → `b` → `a`
      ┌─ scene.xml:6:14
      │
    3 │     <ref id='b'/>
      │              - through this
      ·
    6 │     <ref id='a'/>
      │              ^
    "#);
}

#[test]
fn duplicate_id() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <bsdf type='diffuse' id='a'/>\n  <bsdf type='dielectric' id='a'/>\n</scene>"), @r#"
    error: the id `a` is given twice
      ┌─ scene.xml:3:31
      │
    2 │   <bsdf type='diffuse' id='a'/>
      │                            - first given here
    3 │   <bsdf type='dielectric' id='a'/>
      │                               ^
    "#);
}

#[test]
fn undefined_parameter() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <default name='size' value='5'/>\n  <shape type='sphere'>\n    <float name='radius' value='$sise'/>\n  </shape>\n</scene>"), @r#"
    error: undefined parameter `$sise`
      ┌─ scene.xml:4:33
      │
    4 │     <float name='radius' value='$sise'/>
      │                                 ^^^^^
      │
      = help: with --lenient every place has its default
      = help: did you mean `$size` by `$sise`?
    "#);
    assert_snapshot!(failure_with(
        "<scene version='3.0.0'>\n  <integrator type='$kind'>\n    <integer name='max_depth' value='$depth'/>\n    <integer name='rr_depth' value='$depth'/>\n  </integrator>\n  <bsdf type='$kind$what' id='$id'/>\n</scene>",
        &[],
        &[("what", "two words")],
    ), @r#"
    error: undefined parameters `$kind`, `$depth`, `$id`
      ┌─ scene.xml:2:21
      │
    2 │   <integrator type='$kind'>
      │                     ^^^^^
    3 │     <integer name='max_depth' value='$depth'/>
      │                                      ------ `$depth`
      ·
    6 │   <bsdf type='$kind$what' id='$id'/>
      │                               --- `$id`
      │
      = help: with --lenient every place has its default
      = help: give a value: caustica render scene.xml -D 'what=two words' -D kind=... -D depth=... -D id=...
    "#);
}

/// How the light is computed and stored is not the light.
#[test]
fn undefined_parameter_of_film_sampler_or_integrator() {
    let undefined = "<scene version='3.0.0'>\n  <sensor type='perspective'><sampler type='$kind'/></sensor>\n  <integrator type='path'>\n    <integer name='max_depth' value='$depth'/>\n  </integrator>\n</scene>";
    assert_snapshot!(warnings(undefined, false), @r#"
    warning: undefined parameters `$kind`, `$depth`: every place has its default
      ┌─ scene.xml:2:45
      │
    2 │   <sensor type='perspective'><sampler type='$kind'/></sensor>
      │                                             ^^^^^
    3 │   <integrator type='path'>
    4 │     <integer name='max_depth' value='$depth'/>
      │                                      ------ `$depth`
      │
      = help: give a value: caustica render scene.xml -D kind=... -D depth=...
    "#);
}

#[test]
fn unused_define() {
    assert_snapshot!(failure_with("<scene version='3.0.0'>\n  <default name='spp' value='5'/>\n</scene>", &[], &[("ssp", "3")]), @r#"
    error: the scene never uses the parameter `ssp` given by -D
     = help: did you mean `spp`?
    "#);
}

#[test]
fn definition_after_use() {
    assert_snapshot!(warnings("<scene version='3.0.0'>\n  <integrator type='$kind'/>\n  <default name='kind' value='path'/>\n</scene>", false), @r#"
    warning: `$kind` is used before its <default>
      ┌─ scene.xml:2:21
      │
    2 │   <integrator type='$kind'/>
      │                     ^^^^^
      │
      = help: Mitsuba rejects this; move the <default> up
    "#);
}

#[test]
fn wrong_type() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <shape type='sphere'>\n    <string name='radius' value='2'/>\n  </shape>\n</scene>"), @r#"
    error: parameter `radius` of sphere expects a float, got a string
      ┌─ scene.xml:3:34
      │
    3 │     <string name='radius' value='2'/>
      │                                  ^
    "#);
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <integrator type='path'>\n    <float name='max_depth' value='2'/>\n  </integrator>\n</scene>"), @r#"
    error: parameter `max_depth` of path expects an integer, got a float
      ┌─ scene.xml:3:36
      │
    3 │     <float name='max_depth' value='2'/>
      │                                    ^
    "#);
}

#[test]
fn reflectance_out_of_range() {
    assert_snapshot!(failure("<scene version='3.0.0'>\n  <bsdf type='diffuse'>\n    <rgb name='reflectance' value='1.2 0.5 0'/>\n  </bsdf>\n</scene>"), @r#"
    error: `reflectance` is a reflectance and must lie between 0 and 1, not [1.2, 0.5, 0]
      ┌─ scene.xml:3:36
      │
    3 │     <rgb name='reflectance' value='1.2 0.5 0'/>
      │                                    ^^^^^^^^^
    "#);
    assert_snapshot!(warnings("<scene version='0.6.0'>\n  <bsdf type='diffuse'>\n    <rgb name='reflectance' value='1.2 0.5 0'/>\n  </bsdf>\n</scene>", false), @r#"
    warning: `reflectance` is a reflectance and must lie between 0 and 1, not [1.2, 0.5, 0]
      ┌─ scene.xml:3:36
      │
    3 │     <rgb name='reflectance' value='1.2 0.5 0'/>
      │                                    ^^^^^^^^^
    "#);
}

#[test]
fn unsupported_plugin() {
    let text = "<scene version='3.0.0'>\n  <shape type='cube'>\n    <bsdf type='hair'>\n      <float name='roughness' value='0.2'/>\n    </bsdf>\n  </shape>\n</scene>";
    assert_snapshot!(failure(text), @r#"
    error: bsdf plugin `hair` is not supported yet
      ┌─ scene.xml:3:17
      │
    3 │     <bsdf type='hair'>
      │                 ^^^^
      │
      = help: with --lenient diffuse gray 0.5 is used
    "#);
    assert_snapshot!(warnings(text, true), @r#"
    warning: bsdf plugin `hair` is not supported yet: diffuse gray 0.5 is used
      ┌─ scene.xml:3:17
      │
    3 │     <bsdf type='hair'>
      │                 ^^^^
    "#);
    assert_snapshot!(warnings("<scene version='3.0.0'>\n  <bsdf type='hair' id='a'/>\n</scene>", false), @r#"
    warning: bsdf plugin `hair` is not rendered: nothing uses it
      ┌─ scene.xml:2:15
      │
    2 │   <bsdf type='hair' id='a'/>
      │               ^^^^
    "#);
}

#[test]
fn unknown_integrators_become_photon_mapping() {
    assert_snapshot!(warnings("<scene version='3.0.0'>\n  <integrator type='photonmaper'/>\n</scene>", false), @r#"
    warning: unknown integrator plugin `photonmaper`: photon mapping renders the scene
      ┌─ scene.xml:2:21
      │
    2 │   <integrator type='photonmaper'/>
      │                     ^^^^^^^^^^^
      │
      = help: did you mean `photonmapper`?
    "#);
    assert_snapshot!(warnings("<scene version='2.0.0'>\n  <integrator type='path_sms_ss'/>\n</scene>", false), @r#"
    warning: unknown integrator plugin `path_sms_ss`: photon mapping renders the scene
      ┌─ scene.xml:2:21
      │
    2 │   <integrator type='path_sms_ss'/>
      │                     ^^^^^^^^^^^
    "#);
    assert_snapshot!(warnings("<scene version='0.6.0'>\n  <integrator type='bdpt'/>\n</scene>", false), @r#"
    warning: integrator `bdpt` is read as `path`
      ┌─ scene.xml:2:21
      │
    2 │   <integrator type='bdpt'/>
      │                     ^^^^
    "#);
}

#[test]
fn several_problems_in_source_order() {
    assert_snapshot!(failure(
        "<scene version='3.0.0'>\n  <integrator type='path'>\n    <integer name='max_depth' value='4.0'/>\n  </integrator>\n  <shape type='obj'>\n    <string name='filename' value='no.obj'/>\n    <ref id='nobody'/>\n  </shape>\n  <shape type='sphere'>\n    <float name='radius' value='nan'/>\n    <boolean name='flip' value='yes'/>\n  </shape>\n  <teapot/>\n</scene>"
    ), @r#"
    error: `4.0` is not an integer
      ┌─ scene.xml:3:38
      │
    3 │     <integer name='max_depth' value='4.0'/>
      │                                      ^^^

    error: mesh `no.obj` not found
      ┌─ scene.xml:6:36
      │
    6 │     <string name='filename' value='no.obj'/>
      │                                    ^^^^^^
      │
      = help: searched in: .

    error: no object has the id `nobody`
      ┌─ scene.xml:7:14
      │
    7 │     <ref id='nobody'/>
      │              ^^^^^^

    error: `nan` is not a number
       ┌─ scene.xml:10:33
       │
    10 │     <float name='radius' value='nan'/>
       │                                 ^^^

    error: unknown parameter `flip` of sphere
       ┌─ scene.xml:11:20
       │
    11 │     <boolean name='flip' value='yes'/>
       │                    ^^^^
       │
       = help: it takes: caustic_bouncer, caustic_caster_multi, caustic_caster_single, caustic_receiver, center, exterior, flip_normals, glinty, interior, radius, silhouette_sampling_weight, to_world

    error: `yes` is not a boolean; write `true` or `false`
       ┌─ scene.xml:11:33
       │
    11 │     <boolean name='flip' value='yes'/>
       │                                 ^^^

    error: unknown element <teapot>
       ┌─ scene.xml:13:4
       │
    13 │   <teapot/>
       │    ^^^^^^
       │
       = help: with --lenient it is skipped
    "#);
}
