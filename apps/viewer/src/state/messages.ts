/** A place to go to instead. */
export interface Link {
  readonly label: string;
  readonly href: string;
}

/** A failure as it is shown: a title of a few words, the particulars, and advice. */
export interface FailureReport {
  readonly title: string;
  readonly message: string;
  readonly advice?: string;
  /** The engine's own words, if the message has plainer ones. */
  readonly details?: string;
  /** Whether it is a mistake of ours, not thrown on purpose: particulars belong in the console. */
  readonly isFault?: boolean;
  /** Places to go to instead. */
  readonly links?: readonly Link[];
}

/** Message for code that cannot be fetched: offline, or after a new version was deployed. */
export const NOT_FETCHED = 'This part could not be loaded. Check the connection, then reload the page.';

/** Report on several files that could not be opened. */
export function joinedFailures(failures: readonly FailureReport[]): FailureReport {
  if (failures.length === 1) return failures[0];
  return {
    title: `${failures.length} files cannot be opened`,
    message: failures.map(({ title, message }) => `${title}: ${message}`).join(' '),
    isFault: failures.some(({ isFault }) => isFault),
  };
}

/** Something else that a person may have wanted. */
export interface Offer {
  readonly label: string;
  readonly command: 'flip' | 'outside' | 'inside' | 'undo' | 'bring-back' | 'save';
}

/** A sentence that needs no answer, and commands that it offers. */
export interface Notice {
  readonly text: string;
  readonly offers: readonly Offer[];
}

/** What a person makes of a scene, by the browser's storage for it. */
export type KeptThing = 'edits' | 'views' | 'path' | 'annotations' | 'known length';

/** Messages over the picture. */
export interface MessagesState {
  readonly failure: FailureReport | null;
  readonly notice: string | Notice | null;
  /** What the browser could not store when it was changed last, with its error. */
  readonly unkept: ReadonlyMap<KeptThing, unknown>;
}

/** A notice with another one: what is wrong at once is said at once. */
export function noticeWith(
  before: MessagesState['notice'],
  added: string | Notice,
): NonNullable<MessagesState['notice']> {
  if (before === null) return added;
  if (typeof before === 'string' && typeof added === 'string') return `${before} ${added}`;
  const [first, second] = [before, added].map((each) =>
    typeof each === 'string' ? { text: each, offers: [] } : each,
  );
  return { text: `${first.text} ${second.text}`, offers: [...first.offers, ...second.offers] };
}

/** The state after a thing was stored, or could not be. */
export function withKept(
  { unkept }: Pick<MessagesState, 'unkept'>,
  thing: KeptThing,
  error: unknown = null,
): Pick<MessagesState, 'unkept'> {
  if (error === null && !unkept.has(thing)) return { unkept };
  const others = [...unkept].filter(([each]) => each !== thing);
  return { unkept: new Map(error === null ? others : [...others, [thing, error]]) };
}

export const FIRST_MESSAGES: MessagesState = { failure: null, notice: null, unkept: new Map() };
