/**
 * Returns a shader's source as if these conditions had never existed: without the code that needs
 * them, and without tests of their absence. Parses the text independently of the linker.
 */
export function withoutConditions(source: string, conditions: readonly string[]): string {
  let text = source.replace(/\/\/.*$/gm, '');
  const attribute = /@if\(([^()]*)\)\s*/g;
  for (let match = attribute.exec(text); match; match = attribute.exec(text)) {
    const start = match.index;
    const end = attribute.lastIndex;
    const rest = withoutNames(match[1], conditions);
    if (rest === match[1]) continue;
    const [replacement, last] =
      rest === null ? ['', end + itemLength(text.slice(end))] : [rest === '' ? '' : `@if(${rest}) `, end];
    text = text.slice(0, start) + replacement + text.slice(last);
    attribute.lastIndex = start + replacement.length;
  }
  return text;
}

/** Simplifies a condition for names that are never met: empty if always met then, null if never. */
function withoutNames(condition: string, names: readonly string[]): string | null {
  const alternatives = condition
    .split('||')
    .map((each) => each.split('&&').map((term) => term.trim()))
    .filter((terms) => !terms.some((term) => names.includes(term)))
    .map((terms) => terms.filter((term) => !names.includes(term.replace(/^!/, ''))));
  if (alternatives.length === 0) return null;
  if (alternatives.some((terms) => terms.length === 0)) return '';
  return alternatives.map((terms) => terms.join(' && ')).join(' || ');
}

/** Length of the import, declaration, member or statement that `text` begins with. */
function itemLength(text: string): number {
  const attributes = /^(?:@\w+(?:\([^)]*\))?\s*)*/.exec(text)![0].length;
  const item = text.slice(attributes);
  const isBlock = /^(?:(?:fn|if|for|struct)\b|\{)/.test(item);
  const isMember = /^\w+\s*:/.test(item);
  // Outside of members, < and > are comparisons.
  const [opening, closing] = isMember ? ['({[<', ')}]>'] : ['({[', ')}]'];
  let depth = 0;
  for (let at = 0; at < item.length; at++) {
    const character = item[at];
    if (opening.includes(character)) depth++;
    if (closing.includes(character)) depth--;
    if (depth > 0) continue;
    if (isBlock ? character === '}' : character === (isMember ? ',' : ';')) return attributes + at + 1;
  }
  throw new RangeError(`"${item.slice(0, 40)}" does not end.`);
}
