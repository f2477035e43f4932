/** What a page gives to take away. */
import {html} from '../vendor/htm-preact-3.1.1.js';

export const TakeAway = () => html`<span></span>`;
