/** A place to go to instead. */
export interface Link {
  readonly label: string;
  readonly href: string;
}

/** A failure as it is shown: a title of a few words, the particulars, and advice. */
export interface FailureReport {
  readonly title: string;
  readonly message: string;
  readonly advice: string;
  /** The engine's own words, where the message has plainer ones. */
  readonly details?: string;
  /** Whether it is a mistake of ours, not thrown on purpose: particulars belong in the console. */
  readonly isFault: boolean;
  /** Where to go instead. */
  readonly links?: readonly Link[];
}
