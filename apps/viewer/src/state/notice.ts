/** Something else that a person may have wanted. */
export interface Offer {
  readonly label: string;
  readonly command: 'flip' | 'outside' | 'inside';
}

/** A sentence that needs no answer, and what it offers. */
export interface Notice {
  readonly text: string;
  readonly offers: readonly Offer[];
}
