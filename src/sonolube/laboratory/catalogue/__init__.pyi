from .entry import CatalogueEntry as CatalogueEntry, catalogue_entry as catalogue_entry
from .index import CATALOGUE as CATALOGUE, FoundRuns as FoundRuns, query_runs as query_runs
from .intake import take_in as take_in
from .measured import CATALOGUE_PREFIX as CATALOGUE_PREFIX, catalogued_runs as catalogued_runs
from .query import RunQuery as RunQuery, query_from as query_from
