/** The text that a build has beside its page: licences of the packages whose code is in it. */
export const LICENSES_ADDRESS = 'third-party-licenses.txt';
