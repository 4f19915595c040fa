import { describe, expect, it } from 'vitest';
import { evidenceIndex, evidencePage, evidencePageOf, parseEvidence, readEvidence } from './evidence.ts';
import { DocsError } from './markdown.ts';

const table = { caption: 'Frames', columns: ['splats', 'ms'], rows: [[1_000_000, 0.72]] };
const whole = {
  title: 'Frames on an H200',
  conclusion: 'Tiles are faster.',
  run: { commit: 'abc', date: '2026-11-26', machine: 'two cores' },
  tables: [table],
  remarks: ['Less than `a < b` took 0.152 ms.'],
};
const parse = (value: unknown) => parseEvidence('evidence/frames.json', JSON.stringify(value));

describe('evidence', () => {
  it('of the repository has the format', () => {
    expect(() => readEvidence(new URL('../../../..', import.meta.url).pathname)).not.toThrow();
  });

  it('is read', () => {
    expect(parse(whole)).toEqual(whole);
    expect(
      parse({ ...whole, run: undefined, runs: [{}, { driver: '580' }], tables: undefined }),
    ).toBeTruthy();
  });

  it.each([
    [{ ...whole, extra: 1 }, 'the file has an unknown field “extra”.'],
    [{ ...whole, run: { gpu: 'H200' } }, 'run has an unknown field “gpu”.'],
    [{ ...whole, run: undefined, runs: [{}, { date: 2026 }] }, 'runs[1].date is no text.'],
    [{ ...whole, runs: [] }, 'it has both run and runs.'],
    [{ ...whole, title: '' }, 'title is no text.'],
    [{ ...whole, conclusion: undefined }, 'conclusion is no text.'],
    [
      { ...whole, tables: [table, { ...table, rows: [...table.rows, [1]] }] },
      'tables[1].rows[1] has 1 values',
    ],
    [
      { ...whole, tables: [{ ...table, rows: [[1, true]] }] },
      'tables[0].rows[0] has a value that is neither',
    ],
    [{ ...whole, tables: [{ ...table, note: '' }] }, 'tables[0] has an unknown field “note”.'],
    [{ ...whole, tables: [{ ...table, columns: [1, 2] }] }, 'tables[0].columns has what is no text.'],
    [{ ...whole, remarks: [1] }, 'remarks[0] is no text.'],
    [{ ...whole, remarks: 'a' }, 'remarks is no list.'],
    [{ title: 'a', conclusion: 'b' }, 'it has neither tables nor remarks.'],
    [[], 'the file is no object.'],
  ])('with a mistake is an error that names the file and the place: %#', (value, message) => {
    expect(() => parse(value)).toThrow(DocsError);
    expect(() => parse(value)).toThrow(`evidence/frames.json: ${message}`);
  });

  it('that is no JSON is an error', () => {
    expect(() => parseEvidence('evidence/frames.json', '{')).toThrow(/^evidence\/frames\.json: .*JSON/);
  });
});

describe('the page of evidence', () => {
  it('has everything, and is not searched', () => {
    expect(evidencePage(parse(whole))).toBe(`---
search: false
---

# Frames on an H200

Tiles are faster.

## Runs

| Commit | Date | Machine |
| --- | --- | --- |
| abc | 2026-11-26 | two cores |

## Frames

| splats | ms |
| --- | --- |
| 1,000,000 | 0.72 |

## Remarks

- Less than \`a < b\` took 0.152 ms.
`);
  });

  it('shows text as text, and gaps', () => {
    const rows = [[null, 'a | <b>']];
    expect(evidencePage(parse({ ...whole, tables: [{ ...table, rows }] }))).toContain('| – | a \\| &lt;b> |');
  });

  it('is listed with its conclusion', () => {
    expect(evidenceIndex(new Map([['frames', parse(whole)]]))).toContain(
      '- [Frames on an H200](frames.md): Tiles are faster.',
    );
  });

  it('is found by the path of its file', () => {
    expect(evidencePageOf('evidence/frames.json')).toBe('evidence/frames.md');
    expect(evidencePageOf('evidence/README.md')).toBeNull();
  });
});
