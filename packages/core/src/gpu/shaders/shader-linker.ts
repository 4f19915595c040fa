/**
 * Links the WGSL of shaders/: joins one module and the declarations that it needs from others into
 * one text. In addition to WGSL, modules may contain
 *
 *     import package::lib::packing::unpackSplat;
 *     import package::lib::srgb::{decodeSrgb, encodeSrgb};
 *     import package::effects::fog::fogColor as colorInFog;
 *     @if(SH_1 && !SH_F32) …
 *
 * where the condition precedes an import, a declaration, a member of a struct or a statement, which
 * is removed if the condition is not met. Comments are removed too. A loop of the form
 *
 *     @unroll(!NARROW) for (var item = 0u; item < ITEMS; item++) { … }
 *
 * becomes a block per value of its counter, which stands there as a number: drivers do not unroll
 * loops that contain barriers, and an array that such a loop indexes then lies in memory instead of
 * registers. Where the condition is not met, the loop stays as it is; without a condition it is
 * always written out.
 *
 * The names of an effect's module are its own: where another module has the same name, as a
 * declaration or as a word of WGSL, the effect's declaration is renamed after its module
 * (`wind_sway_noise`). The same holds for the structs of effects' parameters. Names of all other modules
 * are unique: that two of them declare one name is an error, and so is the use of another module's
 * declaration without an import.
 *
 * The linker does not follow scopes: every word that is a name of its module counts as a use of that
 * name, and is renamed with it. A local name that hides one of its module is therefore an error, except
 * in effects, where the hidden declaration is linked and renamed for nothing.
 */

/** Text of modules by name, e.g. `package::lib::packing`. */
export type ShaderModules = Readonly<Record<string, string>>;

export interface LinkInput {
  readonly modules: ShaderModules;
  /** The module whose declarations all stay; of other modules, only declarations that it reaches. */
  readonly root: string;
  /** Conditions that are met; others are not. */
  readonly conditions: Readonly<Record<string, boolean>>;
  /** Every constant that unrolled loops may count to. */
  readonly counts: Readonly<Record<string, number>>;
}

export interface Token {
  /** Empty at the end of the module. */
  readonly text: string;
  /** White space before the token: nothing, a space, or a line break with the indentation. */
  readonly gap: string;
  readonly module: string;
  /** From 1. */
  readonly line: number;
}

/** Meaning of a name in a module. */
type Named = Declaration | Import;

interface Declaration {
  readonly name: Token;
  readonly kind: 'function' | 'struct' | 'other';
  readonly tokens: readonly Token[];
}

interface Import {
  /** Name in the module that declares it. */
  readonly name: Token;
  readonly from: string;
}

/** What the names of a module mean; names of imports as this module has them. */
type Scope = ReadonlyMap<string, Named>;

/** Modules cannot be linked. The message has module and line. */
export class LinkError extends RangeError {
  readonly module: string;
  /** From 1. */
  readonly line: number;
  /** The message without the place. */
  readonly problem: string;

  constructor({ module, line }: Pick<Token, 'module' | 'line'>, problem: string) {
    super(`${module}, line ${line}: ${problem}.`);
    this.module = module;
    this.line = line;
    this.problem = problem;
  }
}

/**
 * Returns the WGSL of the root module with everything that it reaches: each declaration once, after
 * the declarations that it uses.
 * @throws LinkError if the modules cannot be linked.
 */
export function linkModules(input: LinkInput): string {
  return linkTokens(input).map(textOf).join('\n\n');
}

/**
 * Returns the tokens of each declaration of the linked text, which joins them by an empty line.
 * @throws LinkError
 */
export function linkTokens({ modules, root, conditions, counts }: LinkInput): readonly (readonly Token[])[] {
  const scopes = new Map<string, Scope>();
  /** In the order of the result. */
  const linked = new Set<Declaration>();
  /** Declarations that wait for the ones that they use, outermost first. */
  const waiting: Declaration[] = [];
  /** Words that are no names of their module: words of WGSL itself, or forgotten imports. */
  const foreign: Token[] = [];
  /** Declarations whose name means something else where they are used. */
  const hidden = new Set<Declaration>();

  function scopeOf(module: string): Scope {
    let scope = scopes.get(module);
    if (!scope) {
      const met = selectMet(tokensOf(module, modules[module]), conditions);
      scope = readScope(new Cursor(unroll(met, conditions, counts)));
      scopes.set(module, scope);
      for (const named of scope.values()) {
        if ('from' in named && !Object.hasOwn(modules, named.from))
          fail(named.name, `there is no module ${named.from}`);
      }
    }
    return scope;
  }

  function resolve(named: Named): Declaration {
    if (!('from' in named)) return named;
    const found = scopeOf(named.from).get(named.name.text);
    if (!found || 'from' in found) fail(named.name, `${named.from} declares no "${named.name.text}"`);
    return found;
  }

  function add(declaration: Declaration): void {
    const { name } = declaration;
    if (linked.has(declaration)) return;
    if (waiting.includes(declaration)) {
      const circle = [...waiting.slice(waiting.indexOf(declaration)), declaration];
      fail(name, `"${name.text}" uses itself: ${circle.map((each) => each.name.text).join(' → ')}`);
    }
    waiting.push(declaration);
    const scope = scopeOf(name.module);
    for (const word of wordsUsed(declaration, scope)) {
      const named = scope.get(word.text);
      if (!named) {
        foreign.push(word);
        continue;
      }
      const used = resolve(named);
      add(used);
      // Here the import has another name, and its own may mean something else.
      const own = used.name.text;
      if (own !== word.text && declaration.tokens.some(({ text }) => text === own)) hidden.add(used);
    }
    waiting.pop();
    linked.add(declaration);
  }

  if (!Object.hasOwn(modules, root)) throw new RangeError(`There is no shader module ${root}.`);
  for (const named of scopeOf(root).values()) if (!('from' in named)) add(named);
  const renamed = renamedAmong(linked, hidden, foreign);
  const all = Array.from(linked, ({ tokens }) => tokens);
  if (renamed.size > 0) nameAnew(renamed, all);
  /** Names in the result, by module and name there, of names that differ. */
  const names = new Map<string, ReadonlyMap<string, string>>();
  function namesIn(module: string): ReadonlyMap<string, string> {
    let found = names.get(module);
    if (!found) {
      const differing = new Map<string, string>();
      for (const [word, named] of scopeOf(module)) {
        // Imports that nothing uses may be wrong, and are not linked.
        const declaration = 'from' in named ? scopes.get(named.from)?.get(named.name.text) : named;
        if (!declaration || 'from' in declaration) continue;
        const name = renamed.get(declaration) ?? declaration.name.text;
        if (name !== word) differing.set(word, name);
      }
      found = differing;
      names.set(module, found);
    }
    return found;
  }
  return Array.from(linked, (declaration) => withNames(declaration, namesIn(declaration.name.module)));
}

/** Names of an effect's module are its own; see above. */
function isOwn({ name: { module }, tokens }: Declaration): boolean {
  // Code of the host knows what has an attribute by its name: bindings, constants, entry points.
  return isEffect(module) && tokens[0].text !== '@';
}

function isEffect(module: string): boolean {
  return module.startsWith('package::effects::');
}

/**
 * Returns the declarations whose names others have, too, with empty names.
 *
 * @param foreign words that are no names of their module.
 * @throws LinkError if none of two declarations with one name may be renamed, or if an import is forgotten.
 */
function renamedAmong(
  linked: Iterable<Declaration>,
  hidden: ReadonlySet<Declaration>,
  foreign: readonly Token[],
): Map<Declaration, string> {
  const renamed = new Map(Array.from(hidden, (declaration) => [declaration, '']));
  const owners = new Map<string, Declaration>();
  for (const declaration of linked) {
    if (renamed.has(declaration)) continue;
    const { name } = declaration;
    const other = owners.get(name.text);
    const yielding = other && [declaration, other].find((each) => isOwn(each) || isOfParameters(each));
    if (other && !yielding) fail(name, `"${name.text}" is declared by ${placeOf(other.name)} as well`);
    if (yielding) renamed.set(yielding, '');
    if (yielding !== declaration) owners.set(name.text, declaration);
  }
  for (const word of foreign) {
    const owner = owners.get(word.text);
    if (!owner) continue;
    if (!isOwn(owner)) fail(word, `"${word.text}" of ${placeOf(owner.name)} is not imported`);
    renamed.set(owner, '');
  }
  return renamed;
}

/** Whether it is a struct or a list of an effect, whose name follows from the effect's. */
function isOfParameters({ name: { module }, tokens }: Declaration): boolean {
  return module === 'parameters' && tokens[0].text !== '@';
}

/** Gives each of `renamed` a name that none of the tokens have. */
function nameAnew(renamed: Map<Declaration, string>, tokens: readonly (readonly Token[])[]): void {
  const taken = new Set(tokens.flatMap((each) => each.map(({ text }) => text)));
  for (const declaration of renamed.keys()) {
    const { module, text } = declaration.name;
    let name = `${module.slice(module.lastIndexOf(':') + 1)}_${text}`;
    while (taken.has(name)) name += '_';
    taken.add(name);
    renamed.set(declaration, name);
  }
}

/** Returns the tokens of a declaration, with the names of the result. */
function withNames({ kind, tokens }: Declaration, names: ReadonlyMap<string, string>): readonly Token[] {
  if (names.size === 0) return tokens;
  return tokens.map((token, i) => {
    const name = names.get(token.text);
    const before = tokens[i - 1]?.text;
    const isMember = kind === 'struct' && tokens[i + 1]?.text === ':';
    return name === undefined || before === '.' || before === '@' || isMember
      ? token
      : { ...token, text: name };
  });
}

function textOf(tokens: readonly Token[]): string {
  return tokens.map(({ gap, text }, i) => (i === 0 ? text : gap + text)).join('');
}

function placeOf({ module, line }: Pick<Token, 'module' | 'line'>): string {
  return `${module}, line ${line}`;
}

function fail(place: Pick<Token, 'module' | 'line'>, problem: string): never {
  throw new LinkError(place, problem);
}

/** Modules that were read before: each shader of a page links the same libraries. */
const known = new Map<string, { readonly source: string; readonly tokens: readonly Token[] }>();

function tokensOf(module: string, source: string): readonly Token[] {
  const before = known.get(module);
  if (before?.source === source) return before.tokens;
  const tokens = tokenize(module, source);
  known.set(module, { source, tokens });
  return tokens;
}

function tokenize(module: string, source: string): Token[] {
  // As coarse as possible, since the gaps restore the original text: numbers and most operators may
  // be split, as long as no part looks like a name; the operators of conditions and imports stay
  // whole.
  const pattern = /\s+|\/\/.*|\/\*|\w+|::|&&|\|\||./y;
  const tokens: Token[] = [];
  let line = 1;
  let gap = '';
  for (let start = 0; pattern.test(source); start = pattern.lastIndex) {
    const text = source.slice(start, pattern.lastIndex);
    if (text.trim() === '') {
      const lineBreak = text.lastIndexOf('\n');
      if (lineBreak >= 0) {
        // After several line breaks, the last indentation counts.
        gap = text.slice(lineBreak);
        line += lineBreaksIn(text);
      } else if (gap === '') gap = ' ';
    } else if (text === '/*' || text.startsWith('//')) {
      // A comment separates like a space.
      if (gap === '') gap = ' ';
      if (text !== '/*') continue;
      const end = endOfBlockComment(source, start) ?? fail({ module, line }, 'this comment does not end');
      line += lineBreaksIn(source.slice(start, end));
      pattern.lastIndex = end;
    } else {
      tokens.push({ text, gap, module, line });
      gap = '';
    }
  }
  tokens.push({ text: '', gap, module, line });
  return tokens;
}

function lineBreaksIn(text: string): number {
  return text.split('\n').length - 1;
}

/** Returns the end of a block comment, which may nest; undefined if it has none. */
function endOfBlockComment(source: string, start: number): number | undefined {
  const mark = /\/\*|\*\//g;
  mark.lastIndex = start;
  let depth = 0;
  do {
    const match = mark.exec(source);
    if (!match) return undefined;
    depth += match[0] === '/*' ? 1 : -1;
  } while (depth > 0);
  return mark.lastIndex;
}

/** A position among the tokens of a module. */
class Cursor {
  readonly tokens: readonly Token[];
  at = 0;

  constructor(tokens: readonly Token[]) {
    this.tokens = tokens;
  }

  get token(): Token {
    return this.tokens[this.at];
  }

  get isAtEnd(): boolean {
    return this.token.text === '';
  }

  /** Moves past `text` if it is next, and returns whether it was. */
  accept(text: string): boolean {
    const isNext = this.token.text === text;
    if (isNext) this.at++;
    return isNext;
  }

  expect(text: string): void {
    if (!this.accept(text)) fail(this.token, `"${text}" is expected, not ${quoted(this.token)}`);
  }

  takeName(): Token {
    const { token } = this;
    if (!isWord(token)) fail(token, `a name is expected, not ${quoted(token)}`);
    this.at++;
    return token;
  }

  /**
   * Moves past one statement, declaration or import: each ends with its semicolon, or with its last
   * brace if no `else` follows. A semicolon after the braces of an import or struct belongs to it.
   */
  skipStatement(): void {
    const first = this.#beginning();
    for (let depth = 0; depth >= 0 && !this.isAtEnd; ) {
      const { text } = this.token;
      this.at++;
      if ('([{'.includes(text)) depth++;
      else if (')]}'.includes(text)) depth--;
      if (depth !== 0) continue;
      if (text === ';') return;
      if (text === '}' && this.token.text !== 'else') {
        this.accept(';');
        return;
      }
    }
    fail(first, 'what begins here does not end');
  }

  /** Moves past one member of a struct and its comma, which the last member may lack. */
  skipMember(): void {
    const first = this.#beginning();
    // In a type, angle brackets enclose a list; as operators they only appear in parentheses there.
    for (let depth = 0; !this.isAtEnd; this.at++) {
      const { text } = this.token;
      if (depth === 0 && (text === '}' || this.accept(','))) return;
      if ('(<'.includes(text)) depth++;
      else if (')>'.includes(text)) depth--;
    }
    fail(first, 'what begins here does not end');
  }

  /** Returns the first token of the text to skip. */
  #beginning(): Token {
    if (this.isAtEnd || this.token.text === '}')
      fail(this.token, `${quoted(this.token)} is not expected here`);
    return this.token;
  }
}

function quoted({ text }: Token): string {
  return text === '' ? 'the end' : `"${text}"`;
}

function isWord({ text }: Token): boolean {
  return /^[A-Za-z_]/.test(text);
}

/** Returns the tokens whose conditions are met, without the conditions. */
function selectMet(tokens: readonly Token[], conditions: LinkInput['conditions']): Token[] {
  const met: Token[] = [];
  const cursor = new Cursor(tokens);
  /** Open brackets, outermost first. */
  const open: string[] = [];
  /** True from the keyword `struct` to its closing brace; structs contain no other braces. */
  let isStruct = false;
  /** Gap of a met condition, which the token after it inherits. */
  let gap: string | undefined;
  while (!cursor.isAtEnd) {
    const { at, token } = cursor;
    cursor.at++;
    const keyword = token.text === '@' ? cursor.token.text : '';
    if (keyword === 'if' || keyword === 'elif' || keyword === 'else') {
      const before = at > 0 ? tokens[at - 1].text : ';';
      const isInBraces = (open.at(-1) ?? '{') === '{';
      if (keyword !== 'if' || !isInBraces || !(isStruct ? '{,' : '{};').includes(before))
        fail(token, `@${keyword} is not understood here`);
      cursor.at++;
      const isMet = takeCondition(cursor, conditions);
      const start = cursor.at;
      if (isStruct) cursor.skipMember();
      else cursor.skipStatement();
      if (isMet) {
        // The guarded text may contain further conditions.
        cursor.at = start;
        gap = token.gap;
      }
      continue;
    }
    if (token.text === 'struct') isStruct = true;
    else if ('([{'.includes(token.text)) open.push(token.text);
    else if (')]}'.includes(token.text)) open.pop();
    if (token.text === '}') isStruct = false;
    met.push(gap === undefined ? token : { ...token, gap });
    gap = undefined;
  }
  met.push(cursor.token);
  return met;
}

/** Evaluates `(A && !(B || C))`. Reads both sides of an operator, to find the end. */
function takeCondition(cursor: Cursor, conditions: LinkInput['conditions']): boolean {
  function takeOr(): boolean {
    let value = takeAnd();
    while (cursor.accept('||')) value = takeAnd() || value;
    return value;
  }
  function takeAnd(): boolean {
    let value = takeOperand();
    while (cursor.accept('&&')) value = takeOperand() && value;
    return value;
  }
  function takeOperand(): boolean {
    if (cursor.accept('!')) return !takeOperand();
    if (cursor.token.text === '(') return takeCondition(cursor, conditions);
    return conditions[cursor.takeName().text] === true;
  }
  cursor.expect('(');
  const value = takeOr();
  cursor.expect(')');
  return value;
}

/** Returns the tokens without marks `@unroll`; such loops are written out on their condition. */
function unroll(
  tokens: readonly Token[],
  conditions: LinkInput['conditions'],
  counts: LinkInput['counts'],
): Token[] {
  const result: Token[] = [];
  const cursor = new Cursor(tokens);
  while (!cursor.isAtEnd) {
    const mark = cursor.token;
    if (mark.text !== '@' || tokens[cursor.at + 1].text !== 'unroll') {
      result.push(mark);
      cursor.at++;
      continue;
    }
    cursor.at += 2;
    if (cursor.token.text === '(' && !takeCondition(cursor, conditions)) {
      result.push({ ...cursor.token, gap: mark.gap });
      cursor.at++;
      continue;
    }
    const { counter, count } = takeLoopHead(cursor, counts);
    const start = cursor.at;
    cursor.skipStatement();
    const end = cursor.token;
    const body = [...tokens.slice(start, cursor.at), { ...end, text: '' }];
    const [brace, ...rest] = unroll(body, conditions, counts);
    rest.pop();
    const leaves = rest.find(({ text }) => text === 'break' || text === 'continue');
    if (leaves) fail(leaves, `an unrolled loop cannot contain "${leaves.text}"`);
    for (let value = 0; value < count; value++) {
      result.push({ ...brace, gap: mark.gap });
      for (const [i, token] of rest.entries()) {
        const isCounter = token.text === counter && rest[i - 1]?.text !== '.';
        result.push(isCounter ? { ...token, text: `${value}u` } : token);
      }
    }
  }
  result.push(cursor.token);
  return result;
}

/** Reads `for (var item = 0u; item < ITEMS; item++)`. */
function takeLoopHead(cursor: Cursor, counts: LinkInput['counts']): { counter: string; count: number } {
  for (const text of ['for', '(', 'var']) cursor.expect(text);
  const counter = cursor.takeName().text;
  for (const text of ['=', '0u', ';', counter, '<']) cursor.expect(text);
  const bound = cursor.takeName();
  const count = counts[bound.text] ?? fail(bound, `there is no constant "${bound.text}" to count to`);
  for (const text of [';', counter, '+', '+', ')']) cursor.expect(text);
  return { counter, count };
}

function readScope(cursor: Cursor): Scope {
  const scope = new Map<string, Named>();
  while (!cursor.isAtEnd) {
    const all = cursor.accept('import') ? takeImports(cursor) : [takeDeclaration(cursor)].map(byName);
    for (const [name, named] of all) {
      const known = scope.get(name.text);
      if (known) fail(name, `"${name.text}" is declared by ${placeOf(known.name)} as well`);
      scope.set(name.text, named);
    }
  }
  return scope;
}

function byName(named: Named): [Token, Named] {
  return [named.name, named];
}

/** Reads the text after `import`. Returns imports by their names in the module that imports. */
function takeImports(cursor: Cursor): [Token, Import][] {
  const path = [cursor.takeName()];
  const names: [Token, Token][] = [];
  const named = (name: Token) => names.push([cursor.accept('as') ? cursor.takeName() : name, name]);
  while (names.length === 0 && cursor.accept('::')) {
    if (cursor.accept('{')) {
      do named(cursor.takeName());
      while (cursor.accept(','));
      cursor.expect('}');
    } else path.push(cursor.takeName());
  }
  if (names.length === 0) named(path.pop()!);
  cursor.expect(';');
  const from = path.map(({ text }) => text).join('::');
  return names.map(([local, name]) => [local, { name, from }]);
}

const DECLARATION_KEYWORDS = new Set(['alias', 'const', 'fn', 'override', 'struct', 'var']);

const KINDS: Readonly<Record<string, Declaration['kind']>> = { fn: 'function', struct: 'struct' };

function takeDeclaration(cursor: Cursor): Declaration {
  const start = cursor.at;
  cursor.skipStatement();
  const tokens = cursor.tokens.slice(start, cursor.at);
  // Attributes come first, and contain no keywords.
  const keywordAt = tokens.findIndex(({ text }) => DECLARATION_KEYWORDS.has(text));
  if (keywordAt < 0) fail(tokens[0], `"${tokens[0].text}" begins no declaration`);
  const hasList = tokens[keywordAt + 1].text === '<';
  const nameAt = hasList ? tokens.findIndex(({ text }) => text === '>') + 1 : keywordAt + 1;
  const kind = KINDS[tokens[keywordAt].text] ?? 'other';
  return { name: tokens[nameAt], kind, tokens };
}

/** Returns a declaration's words but its name, members, parameters, locals, words after dots. */
function wordsUsed({ name, kind, tokens }: Declaration, scope: Scope): Token[] {
  const isFunction = kind === 'function';
  const used: Token[] = [];
  const locals = new Set<string>();
  const bodyStart = isFunction ? tokens.findIndex(({ text }) => text === '{') : tokens.length;
  for (let i = 0; i < tokens.length; i++) {
    const token = tokens[i];
    const before = tokens[i - 1]?.text;
    if (!isWord(token) || token === name || before === '.' || before === '@') continue;
    const isMemberOrParameter = i < bodyStart && tokens[i + 1].text === ':';
    if (!isMemberOrParameter && !/^(let|var|const)$/.test(before)) {
      used.push(token);
    } else if (isFunction) {
      const hidden = scope.get(token.text);
      if (hidden && !isEffect(token.module))
        fail(token, `the local "${token.text}" hides that of line ${hidden.name.line}`);
      // What it hides counts as used, since it may be before the local begins.
      if (!hidden || hidden.name === name) locals.add(token.text);
    }
  }
  return used.filter(({ text }) => !locals.has(text));
}
