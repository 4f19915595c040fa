// Proves: our linker agrees with `wesl` on all variants of stages.
import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { link as linkByWesl } from 'wesl/core';
import { allStageVariants, spreadByStage } from '../../testing/stage-variants.ts';
import { linkInput } from './link-shader.ts';
import { type LinkInput, linkModules, type ShaderModules } from './shader-linker.ts';

const CONDITIONS = { YES: true, NO: false };
const COUNTS = { THREE: 3, TWO: 2 };

function linkRoot(root: string, modules: ShaderModules = {}): string {
  return linkModules({ modules: { ...modules, root }, root: 'root', conditions: CONDITIONS, counts: COUNTS });
}

describe('the linker of shaders', () => {
  // wesl takes its time: in the short run, some variants of each stage stand for all.
  const variantsEach = process.env.WEBSPLATTER_FULL === '1' ? Number.POSITIVE_INFINITY : 6;
  test('agrees with wesl on variants of every stage', { tags: 'deeper' }, async () => {
    for (const variant of spreadByStage(await allStageVariants(), variantsEach)) {
      const input = linkInput(variant);
      const label = `${variant.stage} ${JSON.stringify(variant.conditions)}`;
      expect(declarationsIn(linkModules(input)), label).toEqual(declarationsIn(await weslText(input)));
    }
  });

  test('puts each declaration once, after those that it uses', () => {
    const modules = {
      'package::shape':
        'import package::area::area; const SIDE = 2.0; fn shape() -> f32 { return area(SIDE); } fn other() { }',
      'package::area': 'struct Unused { a: f32 } fn area(side: f32) -> f32 { return side * side; }',
    };
    const root =
      'import package::shape::{shape, other}; import package::area::area; fn first() { second(); area(1.0); }' +
      ' fn second() { shape(); } fn third() { }';
    expect(namesIn(linkRoot(root, modules))).toEqual(['area', 'SIDE', 'shape', 'second', 'first', 'third']);
  });

  test('includes exactly the declarations that are reached, however modules import each other', () => {
    const anyNode = fc.record({ module: fc.nat(3), uses: fc.array(fc.nat(), { maxLength: 4 }) });
    fc.assert(
      fc.property(fc.array(anyNode, { minLength: 1, maxLength: 20 }), (nodes) => {
        // Each constant uses some of those before it, and the root the last.
        const uses = nodes.map((node, i) => (i === 0 ? [] : node.uses.map((use) => use % i)));
        const moduleOf = (i: number) => `package::module${nodes[i].module}`;
        const lines: Record<string, Set<string>> = {};
        nodes.forEach((_, i) => {
          lines[moduleOf(i)] ??= new Set();
          for (const use of uses[i])
            if (moduleOf(use) !== moduleOf(i)) lines[moduleOf(i)].add(`import ${moduleOf(use)}::n${use};`);
          lines[moduleOf(i)].add(`const n${i} = ${['1', ...uses[i].map((use) => `n${use}`)].join(' + ')};`);
        });
        const modules = Object.fromEntries(
          Object.entries(lines).map(([name, text]) => [name, [...text].join('\n')]),
        );
        const last = nodes.length - 1;
        const reached = new Set([last]);
        for (let i = last; i >= 0; i--) if (reached.has(i)) for (const use of uses[i]) reached.add(use);

        const names = namesIn(
          linkRoot(`import ${moduleOf(last)}::n${last}; const ROOT = n${last};`, modules),
        );
        expect(names.toSorted()).toEqual(['ROOT', ...Array.from(reached, (i) => `n${i}`)].toSorted());
        for (const i of reached)
          for (const use of uses[i]) expect(names.indexOf(`n${use}`)).toBeLessThan(names.indexOf(`n${i}`));
      }),
    );
  });

  test('changes nothing except comments and white space', () => {
    const words = 'a _b1 x.y 0x1fu 1e-37 .5f 1.0 + - -> >>= << && & || | :: ! / * % @ align # ~'.split(' ');
    const gaps = [' ', '\n', '\t', '\r\n  ', ' // @if( {\n', ' /* { */', '/* /* ; */ "*/ ', ' /**/// /*\n'];
    fc.assert(
      fc.property(
        fc.array(fc.tuple(fc.constantFrom(...words), fc.constantFrom(...gaps), fc.constantFrom(' ', '\n'))),
        (pieces) => {
          const body = pieces.map(([word, gap, space]) => `${word}${space}${gap}`).join('');
          const expected = ['fn', 'f()', '{', ...pieces.map(([word]) => word), '}'];
          expect(linkRoot(`fn f() {\n${body}}`).split(/\s+/)).toEqual(expected);
        },
      ),
    );
    // Comments that separated words still do.
    expect(linkRoot('fn/**/f() { let a/* b */= 1; }')).toBe('fn f() { let a = 1; }');
  });

  test('keeps lines and indentation, without those of comments and conditions', () => {
    const linked = linkRoot(`
// The square.
@if(YES)
fn square(/* any */ x: f32) -> f32 {

      // Twice.
  @if(YES) let result = x * x; // Or once.
  @if(NO) let result = x;
  /* The square. */ return result;
}
`);
    expect(linked).toBe('fn square( x: f32) -> f32 {\n  let result = x * x;\n  return result;\n}');
  });

  test.each([
    ['a value', 'fn f() -> f32 { return x; }'],
    ['a type', 'fn f(a: array<x>) { }'],
    ['a size', '@compute @workgroup_size(x) fn f() { }'],
    ['a number of elements', 'var<workgroup> a: array<u32, x>;'],
    ['a function', 'fn f() { let a = -x(1); }'],
    ['a value whose member is used', 'fn f() { x.y = 1; }'],
    ['the label of a case', 'fn f() { switch (1) { case x: { } default: { } } }'],
    ['another name for it', 'alias a = x;'],
  ])('takes %s for a use', (_, text) => {
    expect(namesIn(linkRoot(`import package::x::x; ${text}`, { 'package::x': 'const x = 1;' }))).toContain(
      'x',
    );
  });

  test.each([
    ['a member', 'struct S { x: f32 }'],
    ['a member of a value', 'fn f() { let a = b.x; }'],
    ['an attribute', 'struct S { @x(4) a: f32 }'],
    ['a part of a number', 'const a = 1.x; const b = 0x;'],
    ['a part of a name', 'const ax = 1; const xa = 2; const _x = 3;'],
    ['a comment', 'const a = 1; // x\n/* x */'],
  ])('does not take %s for a use', (_, text) => {
    const names = namesIn(linkRoot(`import package::x::x; ${text}`, { 'package::x': 'const x = 1;' }));
    expect(names).not.toContain('x');
  });

  // «…» marks the text that the condition guards.
  test.each([
    ['an import', '«import package::a::a;» fn f() { x = a; }'],
    [
      'an import of several names',
      '«import package::a::{a, b};» import package::c::c; fn f() { x = a + b + c; }',
    ],
    ['a constant', '«const A = 1;» fn f() { }'],
    ['a function', '«@compute @workgroup_size(1) fn f(a: f32) { x = 1; }» fn g() { }'],
    ['a binding', '«@group(0) @binding(1) var<storage, read> a: array<array<u32, 2>>;» fn f() { }'],
    ['a struct', '«struct S { a: f32, }» struct T { b: f32 }'],
    ['a struct with a semicolon', '«struct S { a: f32, };» struct T { b: f32 }'],
    ['a member', 'struct S { «@size(16) a: array<vec2<f32>, 3>,» b: f32, } fn f() { }'],
    ['the last member', 'struct S { b: f32, «a: array<f32, 2>» } fn f() { }'],
    ['a local value', 'fn f() { «let a = max(1, 2);» let b = 2; }'],
    ['an assignment', 'fn f() { x = 1; «x += 2;» }'],
    ['a block', 'fn f() { «{ x = 1; { y = 2; } }» z = 3; }'],
    ['an if statement', 'fn f() { «if (a) { b = 1; } else if (c) { } else { }» if (d) { } z = 3; }'],
    ['a loop', 'fn f() { «for (var i = 0; i < 3; i++) { x = a[i]; }» z = 3; }'],
    ['a call', 'fn f() { if (a) { «workgroupBarrier();» } }'],
    [
      'a block that has conditions itself',
      'fn f() { «{ @if(YES) let a = 1; @if(NO) { } @if(NO) let a = 2; }» z = 3; }',
    ],
  ])('removes %s if the condition is not met, and nothing else', (_, text) => {
    const modules = { 'package::a': 'const a = 1; const b = 1;', 'package::c': 'const c = 1;' };
    const link = (root: string) => declarationsIn(linkRoot(root, modules));
    expect(link(text.replace('«', '@if(YES) ').replace('»', ''))).toEqual(link(text.replace(/[«»]/g, '')));
    expect(link(text.replace('«', '@if(NO) ').replace('»', ''))).toEqual(link(text.replace(/«.*»/, '')));
  });

  test('writes out unrolled loops, nested ones too', () => {
    const loop = (body: string, counter = 'i', bound = 'TWO') =>
      `@unroll for (var ${counter} = 0u; ${counter} < ${bound}; ${counter}++) { ${body} }`;
    const bodyOf = (statement: string) => linkRoot(`fn f() { ${statement} }`).replaceAll(/\s+/g, ' ');
    expect(bodyOf(loop('a[i] = b.i;'))).toBe('fn f() { { a[0u] = b.i; } { a[1u] = b.i; } }');
    expect(bodyOf(loop('@if(YES) g(i); @if(NO) h(i);', 'i', 'THREE'))).toBe(
      'fn f() { { g(0u); } { g(1u); } { g(2u); } }',
    );
    expect(bodyOf(`g(); ${loop(loop('h(i, j);', 'j'))} g();`)).toBe(
      'fn f() { g(); { { h(0u, 0u); } { h(0u, 1u); } } { { h(1u, 0u); } { h(1u, 1u); } } g(); }',
    );
  });

  test('leaves a loop as it is where the condition for unrolling it is not met', () => {
    const loop = 'for (var i = 0u; i < TWO; i++) { if (i == a) { break; } g(i); }';
    expect(linkRoot(`fn f() {\n  @unroll(NO || !YES) ${loop}\n}`)).toBe(`fn f() {\n  ${loop}\n}`);
    const body = (condition: string) =>
      linkRoot(`fn f() { @unroll${condition} for (var i = 0u; i < TWO; i++) { g(i); } }`);
    expect(body('(YES && !NO)')).toBe(body(''));
    expect(body('(MAYBE)')).toBe(body('(NO)'));
  });

  test.each([
    ['a loop that counts to no constant', 'for (var i = 0u; i < OTHER; i++) { }', 'no constant "OTHER"'],
    ['a loop of another form', 'for (var i = 1u; i < TWO; i++) { }', '"0u" is expected, not "1u"'],
    ['a statement that is no loop', 'g();', '"for" is expected'],
    [
      'a loop that ends early',
      'for (var i = 0u; i < TWO; i++) { if (i == 1u) { break; } }',
      'cannot contain "break"',
    ],
  ])('does not unroll %s', (_, statement, problem) => {
    expect(() => linkRoot(`fn f() {\n @unroll ${statement} }`)).toThrow(problem);
  });

  test('evaluates conditions as JavaScript does', () => {
    const { condition } = fc.letrec<{ condition: string }>((tie) => ({
      condition: fc.oneof(
        { depthSize: 'small', withCrossShrink: true },
        fc.constantFrom('YES', 'NO'),
        fc
          .tuple(tie('condition'), fc.constantFrom('&&', ' || '), tie('condition'))
          .map((parts) => parts.join('')),
        tie('condition').map((inner) => `(${inner} )`),
        // The sign applies to the first operand alone in both languages, unless parenthesised.
        tie('condition').map((inner) => `! ${inner}`),
      ),
    }));
    fc.assert(
      fc.property(condition, (text) => {
        const isMet = new Function('YES', 'NO', `return ${text};`)(CONDITIONS.YES, CONDITIONS.NO);
        expect(namesIn(linkRoot(`@if(${text}) const A = 1; const B = 2;`))).toEqual(
          isMet ? ['A', 'B'] : ['B'],
        );
      }),
    );
  });

  test.each([
    ['an unknown root', {}, 'There is no shader module root.'],
    [
      'an unknown module',
      { root: '\nimport package::a::x;' },
      'root, line 2: there is no module package::a.',
    ],
    [
      'an unknown name',
      { root: 'import a::x;\nimport a::y; fn f() { x(); y(); }', a: 'fn x() { }' },
      'root, line 2: a declares no "y".',
    ],
    [
      'a name that the other module imports itself',
      { root: 'import a::x; fn f() { x(); }', a: 'import b::x;', b: 'fn x() { }' },
      'root, line 1: a declares no "x".',
    ],
    [
      'a name whose condition is not met',
      { root: 'import a::x; fn f() { x(); }', a: '@if(NO) fn x() { }' },
      'root, line 1: a declares no "x".',
    ],
    [
      'a forgotten import',
      { root: 'import a::x;\nimport b::y; fn f() { x(); y(); }', a: '\nfn x() { y(); }', b: 'fn y() { }' },
      'a, line 2: "y" of b, line 1 is not imported.',
    ],
    [
      'a name declared twice, after comments of several lines',
      { root: 'fn f() { }\n// a\n/* b\n\nc */ const f = 1;' },
      'root, line 5: "f" is declared by root, line 1 as well.',
    ],
    [
      'a name declared twice',
      { root: 'fn f() { }\nconst f = 1;' },
      'root, line 2: "f" is declared by root, line 1 as well.',
    ],
    [
      'a name imported and declared',
      { root: 'import a::x;\nfn x() { }', a: 'fn x() { }' },
      'root, line 2: "x" is declared by root, line 1 as well.',
    ],
    [
      'a name that two modules declare',
      { root: 'import a::x;\nfn f() { x(); }\nfn g() { }', a: 'fn x() { g(); }\nfn g() { }' },
      'root, line 3: "g" is declared by a, line 2 as well.',
    ],
    [
      'a local name that hides another',
      { root: 'import a::x; fn f() {\nlet x = 1; }', a: 'fn x() { }' },
      'root, line 2: the local "x" hides that of line 1.',
    ],
    [
      'a parameter that hides another',
      { root: 'const x = 1;\nfn f(x: f32) { }' },
      'root, line 2: the local "x" hides that of line 1.',
    ],
    [
      'functions that call each other across modules',
      {
        root: 'import a::x; fn f() { x(); }',
        a: 'import b::y; fn x() { y(); }',
        b: 'import a::x;\nfn y() { z(); x(); } fn z() { }',
      },
      'a, line 1: "x" uses itself: x → y → x.',
    ],
    [
      'a condition without an end',
      { root: '@if(YES && NO fn f() { }' },
      'root, line 1: ")" is expected, not "fn".',
    ],
    [
      'a condition without a name',
      { root: '@if(YES &&) fn f() { }' },
      'root, line 1: a name is expected, not ")".',
    ],
    [
      'a condition for a parameter',
      { root: 'fn f(a: f32,\n@if(YES) b: f32) { }' },
      'root, line 2: @if is not understood here.',
    ],
    [
      'a condition after an attribute',
      { root: '@compute @if(YES) fn f() { }' },
      'root, line 1: @if is not understood here.',
    ],
    [
      'a condition after a condition',
      { root: '@if(YES) @if(YES) fn f() { }' },
      'root, line 1: @if is not understood here.',
    ],
    [
      'the other case of a condition',
      { root: '@if(NO) fn f() { }\n@else fn f() { }' },
      'root, line 2: @else is not understood here.',
    ],
    [
      'a condition for nothing',
      { root: 'struct S { a: f32, @if(YES) }' },
      'root, line 1: "}" is not expected here.',
    ],
    ['a condition at the end', { root: '@if(YES)' }, 'root, line 1: the end is not expected here.'],
    [
      'a condition in the header of a loop',
      { root: 'fn f() { for (var i = 0; @if(YES) i < 3; i++) { } }' },
      'root, line 1: @if is not understood here.',
    ],
    [
      'a function without an end',
      { root: 'const a = 1;\nfn f() { {\n}' },
      'root, line 2: what begins here does not end.',
    ],
    [
      'a comment without an end',
      { root: 'const a = 1;\n/* /* */' },
      'root, line 2: this comment does not end.',
    ],
    ['a directive', { root: 'enable f16;' }, 'root, line 1: "enable" begins no declaration.'],
    [
      'another name for an import that is a name already',
      { root: 'import a::x as y;\nfn y() { }', a: 'fn x() { }' },
      'root, line 2: "y" is declared by root, line 1 as well.',
    ],
  ])('rejects %s, and says where', (_, modules, message) => {
    const link = () => linkModules({ modules, root: 'root', conditions: CONDITIONS, counts: COUNTS });
    expect(link).toThrow(RangeError);
    expect(link).toThrow(expect.objectContaining({ message }));
  });

  describe('keeps the names of effects apart', () => {
    const link = (root: string, effects: Record<string, string>, others: ShaderModules = {}) => {
      const own = Object.entries(effects).map(([name, text]) => [`package::effects::${name}`, text]);
      return linkRoot(root, { ...others, ...Object.fromEntries(own) }).replaceAll(/\s+/g, ' ');
    };

    // @fault Two effects of one cloud, each right alone, have a helper of the same name.
    // @consequence Both are drawn; before, the cloud and its view never were again.
    test('two effects with a helper of one name', () => {
      const linked = link(
        'import package::effects::a::f; import package::effects::b::g; fn main() { f(); g(); }',
        {
          a: 'fn noise() -> f32 { return 1.0; } fn f() { noise(); }',
          b: 'fn noise() -> f32 { return 2.0; } fn g() { noise(); }',
        },
      );
      expect(linked).toBe(
        'fn noise() -> f32 { return 1.0; } fn f() { noise(); } ' +
          'fn b_noise() -> f32 { return 2.0; } fn g() { b_noise(); } fn main() { f(); g(); }',
      );
    });

    test('functions of one name that are imported from two effects', () => {
      const linked = link(
        'import package::effects::a::f as f0; import package::effects::b::f as f1; fn main() { f0(); f1(); }',
        { a: 'fn f() { }', b: 'fn f() { }' },
      );
      expect(linked).toBe('fn f() { } fn b_f() { } fn main() { f(); b_f(); }');
    });

    test.each([
      ['a constant', 'const PI = 3.14;', 'PI'],
      ['a struct', 'struct PI { PI: f32 }', 'PI(1.0).PI'],
      ['an alias', 'alias PI = f32;', 'PI(1.0)'],
      ['a private variable', 'var<private> PI: f32;', 'PI'],
    ])('%s and one of the engine, whichever is linked first', (_, declaration, use) => {
      const lib = { 'package::lib::light': 'const PI = 3.0; fn lit() -> f32 { return PI; }' };
      const effect = { a: `${declaration} fn f() { let x = ${use}; }` };
      const own = declaration.replace(' PI', ' a_PI');
      const changed = use.replace('PI', 'a_PI');
      for (const main of ['fn main() { f(); lit(); }', 'fn main() { lit(); f(); }']) {
        const root = `import package::effects::a::f; import package::lib::light::lit; ${main}`;
        const linked = link(root, effect, lib);
        expect(linked).toContain(`${own} fn f() { let x = ${changed}; }`);
        expect(linked).toContain('const PI = 3.0; fn lit() -> f32 { return PI; }');
      }
    });

    test('a function that is named like one of WGSL, which other modules call', () => {
      const linked = link(
        'import package::effects::a::f; import package::effects::b::g; fn main() { f(); g(); let x = mix(1.0, 2.0, 0.5); }',
        {
          a: 'fn mix(a: f32) -> f32 { return a; } fn f() { mix(1.0); }',
          b: 'fn g() { mix(1.0, 2.0, 0.5); }',
        },
      );
      expect(linked).toContain('fn a_mix(a: f32) -> f32 { return a; } fn f() { a_mix(1.0); }');
      expect(linked).toContain('fn g() { mix(1.0, 2.0, 0.5); }');
      expect(linked).toContain('let x = mix(1.0, 2.0, 0.5);');
    });

    test('a function that is named like a local of the function that calls it by another name', () => {
      const linked = link(
        'import package::effects::a::changed as hook; fn main(unchanged: f32) { var changed = unchanged; changed = hook(changed); }',
        { a: 'fn changed(x: f32) -> f32 { return x; }' },
      );
      expect(linked).toContain('var changed = unchanged; changed = a_changed(changed);');
    });

    test('a function that is named like the one that calls it by another name', () => {
      const linked = link(
        'import package::effects::a::change as hook; fn change() { hook(); } fn main() { change(); }',
        { a: 'fn change() { }' },
      );
      expect(linked).toBe('fn a_change() { } fn change() { a_change(); } fn main() { change(); }');
    });

    test('locals that hide names of their module, before and after they begin', () => {
      const linked = link(
        'import package::effects::a::f; const noise = 1.0; fn main() { f(); let x = noise; }',
        {
          a: 'fn noise() -> f32 { return 2.0; } fn f() { let x = noise(); { let noise = 3.0; let y = noise; } }',
        },
      );
      expect(linked).toContain(
        'fn a_noise() -> f32 { return 2.0; } fn f() { let x = a_noise(); { let a_noise = 3.0; let y = a_noise; } }',
      );
      expect(
        link('import package::effects::a::f; fn main() { f(); }', {
          a: 'fn f() { let f = 1.0; let x = f; }',
        }),
      ).toContain('fn f() { let f = 1.0; let x = f; }');
    });

    test('members, parameters and attributes, which are not renamed or are so together', () => {
      const linked = link(
        'import package::effects::a::f; const size = 1; fn main() { f(1); let x = size; }',
        {
          a: 'const size = 2; struct S { @size(16) size: f32 } fn f(size: u32) { var s: S; s.size = f32(size); }',
        },
      );
      expect(linked).toContain(
        'struct S { @size(16) size: f32 } const a_size = 2; fn f(a_size: u32) { var s: S; s.size = f32(a_size); }',
      );
    });

    test('structs of parameters that are named like structs of the engine', () => {
      const linked = link(
        'import package::effects::a::f; import parameters::effects; import layout::View; fn main(view: View) { f(effects.a); }',
        { a: 'import parameters::View; fn f(p: View) { let x = p.by; }' },
        {
          layout: 'struct View { size: vec2f }',
          parameters:
            'struct View { by: f32 } struct Effects { a: View } @group(0) @binding(16) var<uniform> effects: Effects;',
        },
      );
      expect(linked).toContain('struct parameters_View { by: f32 }');
      expect(linked).toContain('fn f(p: parameters_View)');
      expect(linked).toContain('struct Effects { a: parameters_View }');
      expect(linked).toContain('fn main(view: View)');
    });

    test('and picks a name that nobody has', () => {
      const linked = link(
        'import package::effects::a::f; fn f_() { let b_f = 1; } fn main() { f(); f_(); } const noise = 1;',
        {
          a: 'fn noise() { } fn a_noise() { } fn f() { noise(); a_noise(); }',
        },
      );
      expect(linked).toContain('fn a_noise_() { }');
      expect(linked).toContain('fn a_noise() { }');
    });

    test('but not those that the host binds by name', () => {
      const effect = { a: 'import parameters::aImage; fn f() { let x = aImage; }' };
      const parameters = '@group(0) @binding(32) var aImage: texture_2d<f32>;';
      const root =
        'import package::effects::a::f; @group(0) @binding(0) var aImage: sampler; fn main() { f(); let x = aImage; }';
      expect(() => link(root, effect, { parameters })).toThrow('"aImage" is declared by');
    });

    test('and still tells of a forgotten import', () => {
      const modules = { 'package::lib::x': 'fn x() { }' };
      const root = 'import package::effects::a::f; import package::lib::x::x; fn main() { f(); x(); }';
      expect(() => link(root, { a: 'fn f() {\n x(); }' }, modules)).toThrow(
        'package::effects::a, line 2: "x" of package::lib::x, line 1 is not imported.',
      );
    });
  });
});

/** Text linked by wesl, which knows no unrolled loops: those are written out beforehand. */
function weslText({ modules, root, conditions, counts }: LinkInput): Promise<string> {
  const { layout, constants, ...files } = modules;
  const weslSrc = Object.fromEntries(
    Object.entries(files).map(([name, text]) => [
      `${name.replace('package::', '').replaceAll('::', '/')}.wgsl`,
      unrolledText(text, conditions, counts),
    ]),
  );
  const virtualLibs = { layout: () => layout, constants: () => constants };
  const options = { weslSrc, rootModuleName: root, conditions: { ...conditions }, virtualLibs };
  return linkByWesl({ ...options, keepComments: false, sourceMap: false }).then(({ dest }) => dest);
}

/** Writes out unrolled loops, each of which ends at the first brace indented like its start. */
function unrolledText(
  text: string,
  conditions: LinkInput['conditions'],
  counts: LinkInput['counts'],
): string {
  const marked = text.replaceAll(/@unroll\((!?)(\w+)\) /g, (_, not: string, condition: string) =>
    (conditions[condition] === true) === (not === '') ? '@unroll ' : '',
  );
  return marked.replace(
    /^( *)@unroll for \(var (\w+) = 0u; \2 < (\w+); \2\+\+\) \{(.*\}$|[\s\S]*?^\1\}$)/gm,
    (_, indent: string, counter: string, bound: string, body: string) =>
      Array.from(
        { length: counts[bound] },
        (_, i) => `${indent}{${body.replaceAll(new RegExp(`\\b${counter}\\b`, 'g'), `${i}u`)}`,
      ).join('\n'),
  );
}

/**
 * Returns the declarations of a WGSL text, sorted, each as its tokens in one line, without commas
 * after the last element of a list: they mean nothing, and wesl, which rewrites lists, adds or
 * removes them.
 */
function declarationsIn(wgsl: string): string[] {
  const declarations: string[] = [];
  let tokens: string[] = [];
  let depth = 0;
  for (const [token] of wgsl.matchAll(
    /(?:\d|\.\d)(?:[eE][-+]|[\w.])*|\w+|<<=|>>=|&&|\|\||->|\+\+|--|<<|>>|[-+*/%&|^<>=!]=|\S/g,
  )) {
    if (')}]'.includes(token) && tokens.at(-1) === ',') tokens.pop();
    tokens.push(token);
    if ('([{'.includes(token)) depth++;
    else if (')]}'.includes(token)) depth--;
    if (depth === 0 && (token === ';' || token === '}')) {
      declarations.push(tokens.join(' '));
      tokens = [];
    }
  }
  return declarations.sort();
}

/** Returns the names that a WGSL text declares, in its order. */
function namesIn(wgsl: string): string[] {
  return [...wgsl.matchAll(/\b(?:fn|struct|const) (\w+)/g)].map(([, name]) => name);
}
