import type { Choices } from './fuzz.ts';

/** Names that readers look for nowhere, or that every object has. */
const ODD_NAMES = [
  ...[
    '',
    ' ',
    '0',
    '-1',
    '0x0',
    '1e0',
    '00',
    '٠',
    'length',
    'toString',
    '__proto__',
    'constructor',
    'version',
  ],
  ...['children', 'lods', 'files', 'extensions', 'extras', 'a'.repeat(3000), '\u0000', '\u202e'],
];

/** Texts of JSON that break readers wherever they stand. */
const SCALARS = [
  ...['null', 'true', 'false', '0', '-0', '-1', '0.5', '1', '2', '3', '7', '255', '65536', '4294967296'],
  ...['1e308', '-1e308', '1e999', '-1e999', '5e-324', '9007199254740991', '9007199254740993', '1e-7'],
  ...['""', '" "', '"x"', '"0"', '"2.0"', '"__proto__"', '"../a.webp"', '"/a"', '"a/"', '"meta.json"'],
  ...[
    '"https://me:secret@example.org/a"',
    '"data:;base64,AAAA"',
    '"\\u0000\\u202e"',
    '"\\ud800"',
    '[]',
    '{}',
  ],
  ...['[null]', '[[]]', '{"toString":1}', '{"valueOf":{"toString":0},"toString":{}}', '{"length":3}'],
];

const DEPTHS = [3, 40, 600, 5000, 10_000, 100_000];
const WIDTHS = [40, 1000, 20_000, 130_000];

/**
 * Writes a value as JSON in which any value may be of another type, deep, wide or missing, and any name another one. The items of a
 * list are as likely to be wrong as one value.
 *
 * @param rate at which each value is wrong.
 */
export function wrongJson(value: unknown, rate: number, choices: Choices): string {
  if (choices.isTrue(rate)) return wrongValue(value, choices);
  if (Array.isArray(value)) {
    const items = value.map((item) => wrongJson(item, rate / value.length, choices));
    return `[${(choices.isTrue(rate) ? wrongItems(items, choices) : items).join(',')}]`;
  }
  if (typeof value !== 'object' || value === null) return JSON.stringify(value);
  const fields = Object.entries(value)
    .filter(([, field]) => field !== undefined)
    .map(([name, field]): [string, string] => [name, wrongJson(field, rate, choices)]);
  return objectText(choices.isTrue(rate) ? wrongFields(fields, choices) : fields);
}

function objectText(fields: readonly (readonly [string, string])[]): string {
  return `{${fields.map(([name, text]) => `${JSON.stringify(name)}:${text}`).join(',')}}`;
}

function wrongValue(value: unknown, choices: Choices): string {
  const right = JSON.stringify(value);
  // Wide and deep ones take long to parse.
  if (choices.isTrue(0.6)) return choices.of(SCALARS);
  const small = right.length < 60 ? right : '{}';
  const item = choices.of(['0', '""', '{}', small, small]);
  const depth = choices.of(DEPTHS);
  const width = Math.min(choices.of(WIDTHS), Math.floor(2e6 / item.length));
  switch (choices.below(8)) {
    case 0:
      return JSON.stringify(right.slice(0, 1000));
    case 1:
      return `[${right}]`;
    case 2:
      return objectText([[choices.of(ODD_NAMES), right]]);
    case 3:
      return '['.repeat(depth) + item + ']'.repeat(depth);
    case 4: {
      const name = choices.of(['a', 'children', 'lods', 'extensions']);
      return `{"${name}":`.repeat(depth) + item + '}'.repeat(depth);
    }
    case 5:
      return `[${new Array(width).fill(item).join(',')}]`;
    case 6:
      return objectText(Array.from({ length: width }, (_, i) => [String(i), item]));
    default:
      return JSON.stringify('y'.repeat(width));
  }
}

function wrongItems(items: readonly string[], choices: Choices): string[] {
  const at = choices.below(items.length + 1);
  const item = items[at] ?? '0';
  switch (choices.below(4)) {
    case 0:
      return items.filter((_, i) => i !== at);
    case 1:
      return items.toSpliced(at, 0, item);
    case 2:
      return items.with(choices.below(items.length) || 0, item).reverse();
    default:
      return new Array(Math.min(choices.of(WIDTHS), Math.floor(1e6 / item.length))).fill(item);
  }
}

function wrongFields(fields: readonly [string, string][], choices: Choices): [string, string][] {
  const at = choices.below(fields.length);
  const [name, text] = fields[at] ?? ['', '0'];
  switch (choices.below(4)) {
    case 0:
      return fields.filter((_, i) => i !== at);
    case 1:
      return [...fields, [choices.of(ODD_NAMES), text]];
    case 2:
      // Of two fields of a name, the last one holds.
      return [...fields, [name, choices.of(SCALARS)]];
    default:
      return [...fields.filter((_, i) => i !== at), [choices.of(ODD_NAMES), text]];
  }
}
